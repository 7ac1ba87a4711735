#pragma once

#include <map>
#include <string>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/style.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

/// Colour scales of a block's products by their names, the same on all dates (formats::ScaleFit).
using BlockScales = std::map<std::string, formats::ColorScale>;

/// Fits them to all scans of the snapshot that have results, whichever of them are exported: products of one snapshot
/// are on one scale in every folder. Rasters are read by rows. Errors: damaged, interrupted.
Result<BlockScales> fit_block_scales(const tile::Store& store, const tile::Snapshot& snapshot,
                                     const Progress& progress);

}  // namespace rayfield::cli
