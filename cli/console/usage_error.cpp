#include "cli/console/usage_error.h"

#include <fmt/core.h>

#include <cctype>
#include <optional>
#include <string_view>

#include "cli/console/suggestion.h"

namespace rayfield::cli {
namespace {

// The first argument that names an option which the command does not have, without its value. A word with dashes is
// never the value of an option; a negative number may be.
std::optional<std::string> unknown_option(const CLI::App& command, const std::vector<std::string>& arguments) {
  for (std::size_t i = 1; i < arguments.size() && arguments[i] != "--"; ++i) {
    const std::string name = arguments[i].substr(0, arguments[i].find('='));
    if (name.size() > 2 && name.rfind("--", 0) == 0 && command.get_option_no_throw(name) == nullptr) return name;
    const bool is_short = name.size() >= 2 && name[0] == '-' && std::isalpha(static_cast<unsigned char>(name[1])) != 0;
    if (is_short && command.get_option_no_throw(name.substr(0, 2)) == nullptr) return name;
  }
  return std::nullopt;
}

Error wrong_usage(std::string where, std::string why, std::string next) {
  return {ErrorCode::usage, "wrong usage", std::move(where), std::move(why), std::move(next)};
}

// "Could not convert: --tile-size = wide", of an option that takes a number.
std::string said_of(const CLI::ParseError& problem) {
  constexpr std::string_view kStart = "Could not convert: ", kMiddle = " = ";
  std::string text = problem.what();
  const std::size_t middle = text.find(kMiddle);
  if (text.rfind(kStart, 0) != 0 || middle == std::string::npos) return text;
  return fmt::format("{}: {} is not a number of the kind that it takes",
                     text.substr(kStart.size(), middle - kStart.size()), text.substr(middle + kMiddle.size()));
}

// What does not begin with a command.
Error no_command(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty()) return wrong_usage("", "no command given", "see `rayfield --help`");
  const std::string& word = arguments.front();
  if (word.size() > 1 && word.front() == '-')
    return wrong_usage(word, "options stand behind the command", "write `rayfield COMMAND " + word + "`");
  return wrong_usage(word, "no such command", suggestion(word, command_names(app), "", "`rayfield --help`"));
}

}  // namespace

const CLI::App* find_command(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (command->get_name() == name) return command;
  return nullptr;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
  return names;
}

Error usage_error(const CLI::App& app, const std::vector<std::string>& arguments, const CLI::ParseError& problem) {
  const CLI::App* command = arguments.empty() ? nullptr : find_command(app, arguments.front());
  if (command == nullptr) return no_command(app, arguments);
  const std::string where = "rayfield " + command->get_name();
  const std::string help = fmt::format("`rayfield {} --help`", command->get_name());
  if (const auto name = unknown_option(*command, arguments))
    return wrong_usage(where, "no such option: " + *name,
                       suggestion(name->substr(name->find_first_not_of('-')), option_names(*command), "--", help));
  return wrong_usage(where, said_of(problem), "see " + help);
}

}  // namespace rayfield::cli
