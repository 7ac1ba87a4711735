#include "cli/console/config_file.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cctype>
#include <set>

#include "cli/console/option_settings.h"
#include "cli/console/suggestion.h"
#include "cli/console/usage_error.h"
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

bool given(const std::vector<std::string>& arguments, const std::string& option) {
  return std::any_of(arguments.begin(), arguments.end(), [&](const std::string& argument) {
    return argument == option || argument.rfind(option + "=", 0) == 0;
  });
}

// The keys that the command line sets itself.
std::set<std::string> settings_of(const std::vector<std::string>& arguments) {
  std::set<std::string> keys;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    std::string setting;
    if (arguments[i] == "--set" && i + 1 < arguments.size()) setting = arguments[i + 1];
    if (arguments[i].rfind("--set=", 0) == 0) setting = arguments[i].substr(6);
    if (const auto parsed = parse_setting(setting)) keys.insert(parsed->first);
  }
  return keys;
}

// Collects the options of a file for one command.
class FileOptions {
 public:
  FileOptions(const CLI::App& command, const std::string& path, const std::vector<std::string>& given_arguments)
      : command_(command), path_(path), given_(given_arguments), given_keys_(settings_of(given_arguments)) {}

  Result<void> add_table(const toml::table& table, bool skip_tables) {
    for (const auto& [key, node] : table) {
      const std::string name(key.str());
      if (!node.is_table()) {
        RAYFIELD_CHECK(add_option(name, node));
      } else if (!skip_tables) {
        RAYFIELD_CHECK(command_.get_option_no_throw("--set") == nullptr ? add_option(name, node)
                                                                        : add_settings(*node.as_table(), name + "."));
      }
    }
    return {};
  }

  const std::vector<std::string>& arguments() const { return arguments_; }
  const ConfigPlaces& places() const { return places_; }

 private:
  std::string place(const toml::node& node, const std::string& name) const {
    return fmt::format("{}:{}: '{}'", path_, node.source().begin.line, name);
  }

  // Options of the algorithms (docs/options.md) in tables below the command's: [process.posts] min_contrast = 2.5 is
  // `--set posts.min_contrast=2.5`.
  Result<void> add_settings(const toml::table& table, const std::string& prefix) {
    for (const auto& [key, node] : table) {
      const std::string name = prefix + std::string(key.str());
      if (const toml::table* inner = node.as_table()) {
        RAYFIELD_CHECK(add_settings(*inner, name + "."));
        continue;
      }
      RAYFIELD_ASSIGN(const std::vector<std::string> values, option_values(node, place(node, name)));
      if (given_keys_.count(name) > 0) continue;
      const std::string value = node.is_array() ? fmt::format("[{}]", fmt::join(values, ",")) : values.front();
      arguments_.push_back(fmt::format("--set={}={}", name, value));
      places_[name] = place(node, name);
    }
    return {};
  }

  Result<void> add_option(const std::string& name, const toml::node& node) {
    const std::string where = place(node, name);
    const CLI::Option* option = command_.get_option_no_throw("--" + name);
    if (option == nullptr || name == "config" || name == "help")
      return fail(
          ErrorCode::usage, "unknown key in configuration", where,
          fmt::format("`rayfield {}` has no such option", command_.get_name()),
          suggestion(name, option_names(command_), "", fmt::format("`rayfield {} --help`", command_.get_name())));
    if (given(given_, "--" + name)) return {};
    RAYFIELD_ASSIGN(const std::vector<std::string> values, option_values(node, where));
    if (option->get_expected_max() == 0) {  // a flag
      if (values.size() == 1 && values.front() == "true")
        arguments_.push_back("--" + name);
      else if (values.size() != 1 || values.front() != "false")
        return fail(ErrorCode::usage, "bad configuration", where, "this option is either true or false", "");
      return {};
    }
    for (const std::string& value : values) arguments_.push_back(fmt::format("--{}={}", name, value));
    places_["--" + name] = where;
    return {};
  }

  const CLI::App& command_;
  const std::string& path_;
  const std::vector<std::string>& given_;
  std::set<std::string> given_keys_;
  std::vector<std::string> arguments_;
  ConfigPlaces places_;
};

// Whether a message speaks of an option, and not of one whose name only begins alike.
bool names_option(const std::string& message, const std::string& option) {
  for (std::size_t at = message.find(option); at != std::string::npos; at = message.find(option, at + 1)) {
    const char next = at + option.size() < message.size() ? message[at + option.size()] : ' ';
    if (next != '-' && std::isalnum(static_cast<unsigned char>(next)) == 0) return true;
  }
  return false;
}

}  // namespace

// Finds --config by itself, since the arguments can only be parsed once the file's options are among them.
Result<ExpandedArguments> expand_config(const CLI::App& app, std::vector<std::string> arguments) {
  std::string path;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--config" && i + 1 < arguments.size()) path = arguments[i + 1];
    if (arguments[i].rfind("--config=", 0) == 0) path = arguments[i].substr(9);
  }
  if (path.empty() || arguments.empty()) return ExpandedArguments{std::move(arguments), {}};
  const CLI::App* command = find_command(app, arguments.front());
  if (command == nullptr) return ExpandedArguments{std::move(arguments), {}};

  RAYFIELD_ASSIGN(const std::string text, read_text_file(path, "cannot read configuration"));
  RAYFIELD_CHECK(check_toml_text(text, "bad configuration", path));
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& e) {
    return fail(ErrorCode::usage, "bad configuration", fmt::format("{}:{}", path, e.source().begin.line),
                e.description(), "");
  }
  for (const auto& [key, node] : root) {
    if (node.is_table() && find_command(app, std::string(key.str())) == nullptr)
      return fail(ErrorCode::usage, "unknown table in configuration",
                  fmt::format("{}:{}: [{}]", path, node.source().begin.line, key.str()), "no command has this name",
                  suggestion(key.str(), command_names(app), "", "`rayfield --help`"));
  }
  FileOptions options(*command, path, arguments);
  RAYFIELD_CHECK(options.add_table(root, true));
  if (const toml::table* own = root[command->get_name()].as_table()) RAYFIELD_CHECK(options.add_table(*own, false));
  ExpandedArguments expanded{arguments, options.places()};
  expanded.arguments.insert(expanded.arguments.begin() + 1, options.arguments().begin(), options.arguments().end());
  return expanded;
}

Error with_config_place(Error error, const ConfigPlaces& places) {
  if (error.code != ErrorCode::usage) return error;
  for (const auto& [name, place] : places)
    if (error.where == name || (name.rfind("--", 0) == 0 && names_option(error.why, name))) {
      error.where = place;
      break;
    }
  return error;
}

}  // namespace rayfield::cli
