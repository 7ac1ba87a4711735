#pragma once

#include <functional>
#include <string>

#include "cli/console/common_options.h"

namespace rayfield::cli {

/// Declares a command whose first argument is the store; others can be added to what is returned. `example`: "rayfield
/// NAME myblock" if empty.
CLI::App* add_store_command(Commands& commands, const std::string& name, const std::string& description,
                            std::function<Result<Outcome>(const std::string&, Context&)> run,
                            const std::string& example = {});

}  // namespace rayfield::cli
