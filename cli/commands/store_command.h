#pragma once

#include <functional>
#include <string>

#include "cli/console/common_options.h"

namespace rayfield::cli {

/// Declares a command whose only argument of its own is the store; options can be added to what is returned.
CLI::App* add_store_command(Commands& commands, const std::string& name, const std::string& description,
                            std::function<Result<Outcome>(const std::string&, Context&)> run);

}  // namespace rayfield::cli
