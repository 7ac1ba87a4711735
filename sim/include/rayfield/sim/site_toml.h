#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "rayfield/core/result.h"
#include "rayfield/sim/site.h"

namespace rayfield::sim {

/// Reads and validates SITE.toml. Errors: bad_input (unreadable, not TOML), usage (unknown key, wrong type, out of
/// range), with path and line.
Result<Site> read_site(const std::filesystem::path& path);
/// The same from text; `name` stands for the path in messages.
Result<Site> parse_site(std::string_view text, const std::string& name);

}  // namespace rayfield::sim
