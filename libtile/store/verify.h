#pragma once

#include <filesystem>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::tile {

/// Store::verify(): looks whether the history is whole, and hashes every file that the newest snapshot (all snapshots
/// with `all`) names.
Result<std::vector<Damage>> verify_store(const std::filesystem::path& folder, bool all, int threads,
                                         Progress& progress);

}  // namespace rayfield::tile
