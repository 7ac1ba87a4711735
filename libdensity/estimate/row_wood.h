#pragma once

#include <span>

#include "libdensity/estimate/row_density.h"
#include "libdensity/voxels/wood.h"

namespace rayfield::density {

/// Enters masked wood into the voxels of a row: half of each cylinder's surface above up_min_m goes to the voxels that
/// it lies in (RowDensity::wood_area; beyond the row's ends to its first or last column), and the columns that it
/// stands in lose its cross-section (RowDensity::free_share, as if upright and as high as the canopy). Time is linear
/// in the wood, but for a look at every row segment per cylinder.
void add_wood(RowDensity& row, std::span<const WoodCylinder> wood);

}  // namespace rayfield::density
