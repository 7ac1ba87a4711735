#pragma once

#include <string>

#include "rayfield/core/progress.h"
#include "rayfield/tile/store.h"

namespace rayfield::tile {

/// Store::repair(): lock, see what is missing, publish what is left and can be made again as a new snapshot.
Result<RepairReport> repair_store(const Store& store, bool dry_run, const std::string& command, Progress& progress);

}  // namespace rayfield::tile
