#pragma once

#include <functional>
#include <span>

#include "libdensity/estimate/row_density.h"
#include "libdensity/integration/plan_raster.h"
#include "libdensity/layout/row_layout.h"
#include "libdensity/leaf/leaf_products.h"
#include "libdensity/results/leaf_values.h"
#include "libdensity/scan/scan_work.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

/// Leaf areas of a scan, row by row, whatever tells the wood.
namespace rayfield::density {

struct LeafMaps {
  LeafValues values;
  PlanRaster plan;
};

/// Density of the leaves alone of one row. `values`: of its `panels`, as the scan's own rays say them; gets leaf areas
/// and their errors in place. Called for several rows at a time.
using LeavesOfRow =
    std::function<Result<RowDensity>(const Row& row, std::span<const Panel> panels, std::span<PanelValue> values)>;

/// Leaf areas of panels and half metres, what descriptors.h says of leaves, and their map. `rows`: in the order of the
/// layout; all that `results` hold.
Result<LeafMaps> make_leaf_maps(ScanWork& work, std::span<const Row* const> rows, const RowLayout& layout,
                                const ScanVoxels& voxels, const ScanResults& results, const LeavesOfRow& leaves_of);

/// The map as it is stored.
Result<tile::StreamedArrays> leaf_map_to_arrays(ScanWork& work, LeafMaps& maps);

}  // namespace rayfield::density
