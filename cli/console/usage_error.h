#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::cli {

/// The command of that name; nothing where there is none.
const CLI::App* find_command(const CLI::App& app, const std::string& name);
/// Names of all commands, in the order of `rayfield --help`.
std::vector<std::string> command_names(const CLI::App& app);
/// Long names of a command's options without their dashes, those that switch something off among them.
std::vector<std::string> option_names(const CLI::App& command);

/// What CLI11 found wrong with the arguments (without the program's name), in the words of our errors. Commands and
/// options that do not exist come with what was probably meant.
Error usage_error(const CLI::App& app, const std::vector<std::string>& arguments, const CLI::ParseError& problem);

}  // namespace rayfield::cli
