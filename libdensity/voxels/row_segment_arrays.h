#pragma once

#include "libdensity/voxels/row_segments.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Stored form, kind "stretches" version 1.
tile::ArraySet row_segments_to_arrays(const RowSegmentList& list);
/// Errors: damaged. Warnings are not stored.
Result<RowSegmentList> row_segments_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
