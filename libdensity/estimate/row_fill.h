#pragma once

#include <span>

#include "libdensity/estimate/row_density.h"
#include "libdensity/estimate/voxel_sums.h"

namespace rayfield::density {

/// Values for voxels whose slab cannot speak for itself (estimate_slabs(): state pooled on entry when they have two
/// rays, unobserved otherwise). All such voxels at the same depth inside the canopy, near along the row
/// and in height, are taken together as one: λ̂ = m/S − H/S² over their pooled rays. They are the inside of dense
/// canopy, and their own rays, few as they are, say so; the better seen voxels beside them are emptier. Where there are
/// too few such rays, and where the canopy is thin, unobserved voxels get the mean of the nearest seen ones. Depth =
/// voxels (chessboard) in the cross-section to the nearest voxel that was seen and is empty, or to the outside.
/// Cross-sections of which less than half was seen are not filled: nothing is invented where nobody looked.
void pool_and_fill(RowDensity& row, std::span<const VoxelSums> sums);
/// Memory that pool_and_fill() takes beside the row and the sums.
std::size_t fill_bytes(const Shape3& shape);

/// Density of every voxel by the published method: (n−1)/n·m/S over the voxel and, while n < min_rays, its neighbours
/// within a cube that grows by one voxel each way (at most six).
void estimate_paper(RowDensity& row, std::span<const VoxelCounters> counters, std::uint32_t min_rays);

}  // namespace rayfield::density
