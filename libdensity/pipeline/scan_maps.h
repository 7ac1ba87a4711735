#pragma once

#include "libdensity/ground/ground_model.h"
#include "libdensity/ground/scan_survey.h"
#include "libdensity/integration/plan_raster.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

/// Maps of a scan that do not come of its voxels.
namespace rayfield::density {

/// Cells between the rows that were scanned but hold no voxels are empty, not unknown: canopy there would have widened
/// the voxel grids, whose width follows the hits.
Result<void> mark_lanes(const RowLayout& layout, const ScanSurvey& survey, double tile_size_m, double cell_m,
                        PlanRaster& plan);

/// Heights at the centres of cells as large as the ground's nodes are apart, made as they are read.
struct GroundMap {
  RasterProduct raster;  ///< without values
  tile::ColumnSource values;
};
/// `ground` has to outlive the result.
Result<GroundMap> ground_map(const GroundModel& ground, const RowLayout& layout);

}  // namespace rayfield::density
