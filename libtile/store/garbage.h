#pragma once

#include <cstdint>
#include <filesystem>

#include "rayfield/core/result.h"

namespace rayfield::tile {

/// Store::gc(): removes files that no snapshot names, temporary files and empty folders; answers the bytes freed, or
/// with `dry_run` the bytes that would be.
Result<std::uint64_t> collect_garbage(const std::filesystem::path& folder, bool dry_run);

}  // namespace rayfield::tile
