#include "cli/console/command_table.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

#include "cli/console/usage_error.h"

namespace rayfield::cli {
namespace {

// The lines below "Example:", without the blanks that they begin with in the help.
std::string example_of(const std::string& footer) {
  std::istringstream lines(footer.substr(std::min(footer.find('\n'), footer.size())));
  std::string example;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin != std::string::npos) example += (example.empty() ? "" : "\n") + line.substr(begin);
  }
  return example;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, separator);) words.push_back(word);
  return words;
}

// "TEXT:{png,csv}", as CLI11 writes what CLI::IsMember allows, or "yes|no" for a name of the type.
std::vector<std::string> choices_of(const std::string& type) {
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open != std::string::npos && close != std::string::npos)
    return split(type.substr(open + 1, close - open - 1), ',');
  const bool in_small_letters = std::none_of(type.begin(), type.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  return in_small_letters && type.find('|') != std::string::npos ? split(type, '|') : std::vector<std::string>{};
}

bool is_path(const std::string& value) {
  constexpr std::array<std::string_view, 11> kNoPaths = {
      "N", "SIZE", "KEY=VALUE", "DATE", "DATE[,DATE...]", "FLOAT", "INT", "UINT", "COMMAND", "UNIT", "NAME"};
  return std::find(kNoPaths.begin(), kNoPaths.end(), value) == kNoPaths.end();
}

OptionEntry entry_of(const CLI::Option& option) {
  OptionEntry entry;
  const bool is_argument = option.get_positional();
  if (is_argument) entry.names = {option.get_name(true)};
  for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  entry.meaning = option.get_description();
  entry.is_common = option.get_group() == "Common" || entry.names.back() == "--help";
  entry.is_required = option.get_required();
  if (!is_argument && option.get_expected_max() == 0) return entry;
  const std::string type = option.get_type_name();
  entry.choices = choices_of(type);
  entry.value = is_argument ? entry.names.front() : type.substr(0, type.find(':'));
  entry.is_list = option.get_delimiter() == ',';
  entry.takes_path = entry.choices.empty() && is_path(entry.value);
  return entry;
}

}  // namespace

std::vector<CommandEntry> command_table(const CLI::App& app) {
  std::vector<CommandEntry> table;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    CommandEntry entry{command->get_name(), command->get_description(), example_of(command->get_footer()), {}, {}};
    for (const CLI::Option* option : command->get_options()) {
      OptionEntry described = entry_of(*option);
      if (option->get_positional() && described.value == "COMMAND" && described.choices.empty())
        described.choices = command_names(app);
      (option->get_positional() ? entry.arguments : entry.options).push_back(std::move(described));
    }
    table.push_back(std::move(entry));
  }
  return table;
}

}  // namespace rayfield::cli
