#pragma once

#include <set>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/tile/store.h"

namespace rayfield::tile {

/// A scan as its sealed files describe it, without those in `named`, which belong to others. What only a snapshot knows
/// (inputs, beam, whether it is dormant) stays empty; derived data is found again by `process`.
/// Errors: damaged (no whole scan: tiles are missing, or of several versions), resources, interrupted.
Result<ScanEntry> rebuild_scan(const Store& store, const std::string& scan_id, const std::set<std::string>& named,
                               Progress& progress);

/// The registry as its files describe it. Kinds with several files are left out and named in `left_out`.
Result<std::vector<DerivedEntry>> rebuild_registry(const Store& store, std::vector<std::string>& left_out);

}  // namespace rayfield::tile
