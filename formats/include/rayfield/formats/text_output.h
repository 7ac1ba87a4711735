#pragma once

#include <string>
#include <string_view>

#include "rayfield/core/result.h"

namespace rayfield::formats {

/// Writes a text whole: it appears under its name only when it is complete and synced. `what` names the job in
/// messages. Errors: usage (no such folder), resources.
Result<void> write_text_file(const std::string& path, std::string_view text, const std::string& what);

}  // namespace rayfield::formats
