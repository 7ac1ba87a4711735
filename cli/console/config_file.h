#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::cli {

/// Puts the options of `--config FILE.toml` into the arguments of the command line. The file's keys are long option
/// names without dashes, at the top level or in a table named like the command; what the command line gives itself
/// wins. Tables below the command's hold options of its algorithms (option_settings.h). Unknown keys are refused with
/// their line. `arguments`: without the program's name. Errors: usage, bad_input.
Result<std::vector<std::string>> expand_config(const CLI::App& app, std::vector<std::string> arguments);

}  // namespace rayfield::cli
