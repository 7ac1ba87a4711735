#pragma once

#include <filesystem>

#include "rayfield/core/result.h"
#include "rayfield/tile/garbage.h"

namespace rayfield::tile {

/// Store::gc(): clears away files that no snapshot names, temporary files and empty folders. Only names of our own are
/// touched, below the store's own folder. Errors: damaged (links; snapshots that are missing or cannot be read),
/// locked, resources.
Result<GarbageReport> collect_garbage(const std::filesystem::path& folder, const GarbageOptions& options);

}  // namespace rayfield::tile
