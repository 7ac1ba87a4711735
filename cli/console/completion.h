#pragma once

#include <span>
#include <string>

#include "cli/console/command_table.h"

namespace rayfield::cli {

/// Scripts that make a shell complete commands, options and what they may be; of everything else, files. For bash
/// (without the package bash-completion), zsh (`#compdef`) and fish.
std::string bash_completion(std::span<const CommandEntry> commands);
std::string zsh_completion(std::span<const CommandEntry> commands);
std::string fish_completion(std::span<const CommandEntry> commands);

}  // namespace rayfield::cli
