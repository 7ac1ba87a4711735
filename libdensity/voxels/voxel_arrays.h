#pragma once

#include "libdensity/voxels/voxel_grid.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Stored form of a tile's voxels, kind "voxels" version 1 (docs/density.md has the columns). Sums that the estimators
/// need only where something was hit are kept only there: about 16 B per voxel before compression.
tile::ArraySet arrays_from_voxels(const TileVoxels& voxels);
/// Errors: damaged (wrong kind, columns missing or of inconsistent length, numbers out of range).
Result<TileVoxels> voxels_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
