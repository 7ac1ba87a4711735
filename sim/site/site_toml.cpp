#include "rayfield/sim/site_toml.h"

#include <fmt/core.h>
#include <toml++/toml.h>

#include <cmath>
#include <set>
#include <sstream>

#include "rayfield/core/text_file.h"
#include "sim/site/site_fields.h"

namespace rayfield::sim {
namespace {

// Visits every field, takes its value from the TOML tree and keeps the first error with its line.
class TomlReader {
 public:
  TomlReader(const toml::table& root, std::string name) : name_(std::move(name)) { levels_.push_back({&root, "", {}}); }

  // Set at the first error: "path:line: key" and the reason.
  std::string where, why;

  void enter(std::string_view table) {
    const toml::node* node = take(table);
    const toml::table* inner = node == nullptr ? nullptr : node->as_table();
    if (node != nullptr && inner == nullptr) complain(*node, table, "it must be a table");
    levels_.push_back({inner, key_of(table) + ".", {}});
  }
  void leave() {
    refuse_unknown();
    levels_.pop_back();
  }
  void number(std::string_view key, double& value, double low, double high) {
    if (const toml::node* node = take(key)) read_number(*node, key, value, low, high);
  }
  template <class T>
  void integer(std::string_view key, T& value, double low, double high) {
    const toml::node* node = take(key);
    if (node == nullptr) return;
    double number = 0;
    if (!node->is_integer()) return complain(*node, key, "it must be a whole number");
    if (read_number(*node, key, number, low, high)) value = static_cast<T>(*node->value<std::int64_t>());
  }
  void flag(std::string_view key, bool& value) {
    const toml::node* node = take(key);
    if (node == nullptr) return;
    if (!node->is_boolean()) return complain(*node, key, "it must be true or false");
    value = *node->value<bool>();
  }
  void text(std::string_view key, std::string& value) {
    const toml::node* node = take(key);
    if (node == nullptr) return;
    if (node->is_date()) {  // an unquoted TOML date counts as its text
      std::ostringstream out;
      out << *node->value<toml::date>();
      value = out.str();
    } else if (node->is_string()) {
      value = *node->value<std::string>();
    } else {
      complain(*node, key, "it must be a string");
    }
  }
  template <class E, std::size_t N>
  void choice(std::string_view key, E& value, const Choices<E, N>& choices) {
    const toml::node* node = take(key);
    if (node == nullptr) return;
    const std::string given = node->value_or(std::string());
    std::string known;
    for (const auto& [text, choice] : choices) {
      if (given == text) {
        value = choice;
        return;
      }
      known += (known.empty() ? "" : ", ") + std::string(text);
    }
    complain(*node, key, "it must be one of: " + known);
  }
  void numbers(std::string_view key, std::vector<double>& values, double low, double high, std::size_t most) {
    read_array(key, values, low, high, most);
  }
  void integers(std::string_view key, std::vector<int>& values, double low, double high, std::size_t most) {
    read_array(key, values, low, high, most);
  }
  void vector3(std::string_view key, Eigen::Vector3d& value) {
    std::vector<double> values{value.x(), value.y(), value.z()};
    const toml::node* node = peek(key);
    read_array(key, values, -10, 10, 3);
    if (node == nullptr) return;
    if (values.size() != 3) return complain(*node, key, "it must hold three numbers");
    value = {values[0], values[1], values[2]};
  }
  void rigid(std::string_view key, Rigid3& value) {
    const toml::node* node = peek(key);
    if (node == nullptr) return;
    enter(key);
    vector3("xyz", value.translation);
    const toml::node* rotation = peek("q");
    const Eigen::Vector4d& old = value.rotation.coeffs();
    std::vector<double> q{old[0], old[1], old[2], old[3]};
    read_array("q", q, -1, 1, 4);
    if (rotation != nullptr && q.size() != 4) complain(*rotation, "q", "it must hold four numbers x, y, z, w");
    if (q.size() == 4) {
      const Eigen::Quaterniond read(q[3], q[0], q[1], q[2]);
      if (std::abs(read.norm() - 1) > 1e-3)
        complain(rotation == nullptr ? *node : *rotation, "q", "the quaternion is not of unit length");
      else
        value.rotation = read.normalized();
    }
    leave();
  }
  template <class T, class F>
  void tables(std::string_view key, std::vector<T>& items, F&& visit) {
    const toml::node* node = take(key);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    if (array == nullptr) return complain(*node, key, "it must be an array of tables");
    items.clear();
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::table* inner = (*array)[i].as_table();
      if (inner == nullptr) return complain((*array)[i], key, "it must be an array of tables");
      levels_.push_back({inner, fmt::format("{}[{}].", key_of(key), i), {}});
      items.emplace_back();
      visit(items.back());
      leave();
    }
  }
  void refuse_unknown() {
    const Level& level = levels_.back();
    if (level.table == nullptr) return;
    for (const auto& [key, node] : *level.table)
      if (level.known.count(std::string(key.str())) == 0) complain(node, key.str(), "this key is unknown");
  }
  void complain(const toml::node& node, std::string_view key, std::string reason) {
    if (!where.empty()) return;
    where = fmt::format("{}:{}: {}", name_, node.source().begin.line, key_of(key));
    why = std::move(reason);
  }

 private:
  struct Level {
    const toml::table* table;  // null: absent, every value keeps its default
    std::string prefix;
    std::set<std::string> known;
  };
  std::string name_;
  std::vector<Level> levels_;

  std::string key_of(std::string_view key) const { return levels_.back().prefix + std::string(key); }
  const toml::node* peek(std::string_view key) const {
    return levels_.back().table == nullptr ? nullptr : levels_.back().table->get(key);
  }
  const toml::node* take(std::string_view key) {
    levels_.back().known.emplace(key);
    return peek(key);
  }
  bool read_number(const toml::node& node, std::string_view key, double& value, double low, double high) {
    if (!node.is_number()) {
      complain(node, key, "it must be a number");
      return false;
    }
    const double read = *node.value<double>();
    if (!(read >= low && read <= high)) {
      complain(node, key, fmt::format("{} is outside {} … {}", read, low, high));
      return false;
    }
    value = read;
    return true;
  }
  template <class T>
  void read_array(std::string_view key, std::vector<T>& values, double low, double high, std::size_t most) {
    const toml::node* node = take(key);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    if (array == nullptr) return complain(*node, key, "it must be an array of numbers");
    if (array->size() > most) return complain(*node, key, fmt::format("it holds more than {} values", most));
    values.clear();
    for (const toml::node& item : *array) {
      double value = 0;
      if (std::is_integral_v<T> && !item.is_integer()) return complain(item, key, "it must hold whole numbers");
      if (!read_number(item, key, value, low, high)) return;
      values.push_back(static_cast<T>(value));
    }
  }
};

std::size_t line_of(const toml::table& root, std::string_view key) {
  // The deepest node that exists on the way to the key: an absent key is reported at its table.
  std::string path(key);
  while (!path.empty()) {
    if (const auto view = toml::at_path(root, path)) return view.node()->source().begin.line;
    const std::size_t cut = path.find_last_of(".[");
    path = cut == std::string::npos ? "" : path.substr(0, cut);
  }
  return 1;
}

}  // namespace

Result<Site> parse_site(std::string_view text, const std::string& name) {
  constexpr std::string_view kWhat = "cannot read site";
  constexpr std::string_view kNext = "see docs/simulation.md for the keys";
  RAYFIELD_CHECK(check_toml_text(text, kWhat, name, kNext));
  toml::table root;
  try {
    root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    return fail(ErrorCode::bad_input, kWhat, fmt::format("{}:{}", name, error.source().begin.line),
                fmt::format("not valid TOML: {}", error.description()), kNext);
  }
  Site site;
  TomlReader reader(root, name);
  visit_site(reader, site);
  reader.refuse_unknown();
  if (!reader.where.empty()) return fail(ErrorCode::usage, kWhat, reader.where, reader.why, kNext);
  const SiteFinding finding = check_consistency(site);
  if (!finding.key.empty())
    return fail(ErrorCode::usage, kWhat, fmt::format("{}:{}: {}", name, line_of(root, finding.key), finding.key),
                finding.why, kNext);
  return site;
}

Result<Site> read_site(const std::filesystem::path& path) {
  RAYFIELD_ASSIGN(const std::string text, read_text_file(path.string(), "cannot read site"));
  return parse_site(text, path.string());
}

}  // namespace rayfield::sim
