#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "rayfield/core/result.h"

/// Small text files that people write: rig, site and configuration files.
namespace rayfield {

/// Larger files are not such text: a bag or a disk image was named by mistake.
inline constexpr std::size_t kMaxTextFileBytes = std::size_t{1} << 20;

/// The whole file; `what` names the job in messages. Errors: bad_input (missing, a folder or a pipe, larger than
/// kMaxTextFileBytes), resources (no permission).
Result<std::string> read_text_file(const std::string& path, std::string_view what);

/// TOML allows no control characters except tabs and line ends, and toml++ 3.3 relies on this in places; keys of
/// thousands of parts exhaust its stack. Every text is checked here before it is parsed. Errors: usage, with the line.
Result<void> check_toml_text(std::string_view text, std::string_view what, const std::string& name,
                             std::string_view next = {});

}  // namespace rayfield
