#pragma once

#include <string>
#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// Names of the rasters that process() leaves in the store for every scan.
inline constexpr const char* kRasterNames[] = {"plan_density", "plan_density_se", "canopy_height", "ground"};

/// The block's rows, panels, posts and the results of the scans named (all if empty), in the order of their dates.
/// Errors: usage (nothing processed yet, unknown scan), damaged.
Result<BlockProducts> load_block(const tile::Store& store, const tile::Snapshot& snapshot,
                                 const std::vector<std::string>& scan_ids);

/// One raster of one scan. Errors: usage (not processed yet), damaged.
Result<RasterProduct> load_raster(const tile::Store& store, const tile::ScanEntry& scan, const std::string& name);

/// Scans whose id or date is among `wanted` (all if empty). Errors: usage, naming what is not there.
Result<std::vector<std::string>> select_scans(const tile::Snapshot& snapshot, const std::vector<std::string>& wanted);

}  // namespace rayfield::density
