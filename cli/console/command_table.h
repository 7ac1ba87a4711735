#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace rayfield::cli {

/// What an option or an argument takes, as `--help` shows it.
struct OptionEntry {
  std::vector<std::string> names;    ///< "-o", "--output"; of an argument its one name, "STORE"
  std::string value;                 ///< "FILE.toml"; empty: a flag
  std::vector<std::string> choices;  ///< the words that it may be, where there are few
  std::string meaning;
  bool is_common = false;  ///< of all commands
  bool is_required = false;
  bool is_list = false;     ///< several values with commas between them
  bool takes_path = false;  ///< the value may be a file or folder
};

struct CommandEntry {
  std::string name, meaning, example;
  std::vector<OptionEntry> options, arguments;  ///< in the order of `--help`
};

/// All commands as they were declared: what `--help`, the manual and the completion of shells are made of.
std::vector<CommandEntry> command_table(const CLI::App& app);

}  // namespace rayfield::cli
