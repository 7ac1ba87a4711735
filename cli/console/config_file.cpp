#include "cli/console/config_file.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <algorithm>
#include <set>

#include "rayfield/core/text_file.h"

namespace rayfield::cli {
namespace {

// The value as the command line would have it; tables and dates are not option values.
Result<std::vector<std::string>> option_values(const toml::node& node, const std::string& where) {
  std::vector<std::string> values;
  const auto scalar = [&values](const toml::node& n) {
    if (const auto text = n.value<std::string>(); n.is_string())
      values.push_back(*text);
    else if (n.is_integer())
      values.push_back(std::to_string(*n.value<std::int64_t>()));
    else if (n.is_floating_point())
      values.push_back(fmt::format("{}", *n.value<double>()));
    else if (n.is_boolean())
      values.emplace_back(*n.value<bool>() ? "true" : "false");
    else
      return false;
    return true;
  };
  bool good = true;
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& item : *array) good = good && scalar(item);
  } else {
    good = scalar(node);
  }
  if (!good)
    return fail(ErrorCode::usage, "bad configuration", where, "not a text, number, true/false or list of these", "");
  return values;
}

// Options of the algorithms (docs/options.md) in tables below the command's: [process.posts] min_contrast = 2.5 is
// `--set posts.min_contrast=2.5`.
Result<void> append_settings(const toml::table& table, const std::string& prefix, const std::string& path,
                             std::vector<std::string>& out) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    if (const toml::table* inner = node.as_table()) {
      RAYFIELD_CHECK(append_settings(*inner, name + ".", path, out));
      continue;
    }
    RAYFIELD_ASSIGN(const std::vector<std::string> values,
                    option_values(node, fmt::format("{}:{}: '{}'", path, node.source().begin.line, name)));
    const std::string value = node.is_array() ? fmt::format("[{}]", fmt::join(values, ",")) : values.front();
    out.push_back(fmt::format("--set={}={}", name, value));
  }
  return {};
}

bool given(const std::vector<std::string>& arguments, const std::string& option) {
  return std::any_of(arguments.begin(), arguments.end(), [&](const std::string& argument) {
    return argument == option || argument.rfind(option + "=", 0) == 0;
  });
}

Result<void> append_table(const CLI::App& command, const toml::table& table, const std::string& path, bool skip_tables,
                          const std::vector<std::string>& given_arguments, std::vector<std::string>& out) {
  for (const auto& [key, node] : table) {
    if (skip_tables && node.is_table()) continue;
    const std::string name(key.str());
    if (node.is_table() && command.get_option_no_throw("--set") != nullptr) {
      RAYFIELD_CHECK(append_settings(*node.as_table(), name + ".", path, out));
      continue;
    }
    const std::string where = fmt::format("{}:{}: '{}'", path, node.source().begin.line, name);
    const CLI::Option* option = command.get_option_no_throw("--" + name);
    if (option == nullptr || name == "config" || name == "help")
      return fail(ErrorCode::usage, "unknown key in configuration", where,
                  fmt::format("`rayfield {}` has no such option", command.get_name()),
                  fmt::format("see `rayfield {} --help`", command.get_name()));
    if (given(given_arguments, "--" + name)) continue;
    RAYFIELD_ASSIGN(const std::vector<std::string> values, option_values(node, where));
    if (option->get_expected_max() == 0) {  // a flag
      if (values.size() == 1 && values.front() == "true")
        out.push_back("--" + name);
      else if (values.size() != 1 || values.front() != "false")
        return fail(ErrorCode::usage, "bad configuration", where, "this option is either true or false", "");
      continue;
    }
    for (const std::string& value : values) out.push_back(fmt::format("--{}={}", name, value));
  }
  return {};
}

}  // namespace

// Finds --config by itself, since the arguments can only be parsed once the file's options are among them.
Result<std::vector<std::string>> expand_config(const CLI::App& app, std::vector<std::string> arguments) {
  std::string path;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--config" && i + 1 < arguments.size()) path = arguments[i + 1];
    if (arguments[i].rfind("--config=", 0) == 0) path = arguments[i].substr(9);
  }
  if (path.empty() || arguments.empty()) return arguments;
  const CLI::App* command = nullptr;
  for (const CLI::App* candidate : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (candidate->get_name() == arguments.front()) command = candidate;
  }
  if (command == nullptr) return arguments;

  RAYFIELD_ASSIGN(const std::string text, read_text_file(path, "cannot read configuration"));
  RAYFIELD_CHECK(check_toml_text(text, "bad configuration", path));
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& e) {
    return fail(ErrorCode::usage, "bad configuration", fmt::format("{}:{}", path, e.source().begin.line),
                e.description(), "");
  }
  std::vector<std::string> extra;
  std::set<std::string> names;
  for (const CLI::App* candidate : app.get_subcommands([](const CLI::App*) { return true; }))
    names.insert(candidate->get_name());
  for (const auto& [key, node] : root) {
    if (node.is_table() && names.count(std::string(key.str())) == 0)
      return fail(ErrorCode::usage, "unknown table in configuration",
                  fmt::format("{}:{}: [{}]", path, node.source().begin.line, key.str()), "no command has this name",
                  "");
  }
  RAYFIELD_CHECK(append_table(*command, root, path, true, arguments, extra));
  if (const toml::table* own = root[command->get_name()].as_table())
    RAYFIELD_CHECK(append_table(*command, *own, path, false, arguments, extra));
  arguments.insert(arguments.begin() + 1, extra.begin(), extra.end());
  return arguments;
}

}  // namespace rayfield::cli
