#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::cli {

/// Where the values of a configuration file stand ("process.toml:7: 'voxel-size'"), by option ("--voxel-size") or key
/// of --set ("posts.min_contrast").
using ConfigPlaces = std::map<std::string, std::string>;

struct ExpandedArguments {
  std::vector<std::string> arguments;
  ConfigPlaces places;  ///< of what the file gave
};

/// Puts the options of `--config FILE.toml` into the arguments of the command line. The file's keys are long option
/// names without dashes, at the top level or in a table named like the command; what the command line gives itself
/// wins. Tables below the command's hold options of its algorithms (option_settings.h). Unknown keys are refused with
/// their line. `arguments`: without the program's name. Errors: usage, bad_input.
Result<ExpandedArguments> expand_config(const CLI::App& app, std::vector<std::string> arguments);

/// A usage error about a value of the configuration file is given the value's place.
Error with_config_place(Error error, const ConfigPlaces& places);

}  // namespace rayfield::cli
