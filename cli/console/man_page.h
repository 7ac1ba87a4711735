#pragma once

#include <span>
#include <string>

#include "cli/console/command_table.h"

namespace rayfield::cli {

/// Pages of section 1 in the macros of man(7): of the program, `rayfield.1`, and of one command,
/// `rayfield-process.1`. `version` and `date` (YYYY-MM-DD) stand at their foot.
std::string program_page(std::span<const CommandEntry> commands, const std::string& version, const std::string& date);
std::string command_page(const CommandEntry& command, const std::string& version, const std::string& date);

}  // namespace rayfield::cli
