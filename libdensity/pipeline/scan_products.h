#pragma once

#include <span>

#include "libdensity/scan/scan_stages.h"
#include "libdensity/voxels/row_segments.h"
#include "libdensity/voxels/wood.h"
#include "rayfield/core/products.h"

namespace rayfield::density {

/// Panels, half metres, sections and rasters from the counters (kinds "results" and "raster").
Result<ScanResults> integrate_scan(ScanWork& work, const RowLayout& layout, const SurveyedScan& surveyed,
                                   const RowSegmentList& row_segments, std::span<const WoodCylinder> wood,
                                   std::span<const tile::TileIndex> tiles);

}  // namespace rayfield::density
