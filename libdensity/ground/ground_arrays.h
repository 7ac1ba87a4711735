#pragma once

#include <utility>

#include "libdensity/ground/ground.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Stored form, kind "ground" version 1: column "height_m" of the tile's nodes.
tile::ArraySet ground_to_arrays(tile::TileIndex index, const GroundTile& ground);
/// The nodes and their tile. Errors: damaged.
Result<std::pair<tile::TileIndex, GroundTile>> ground_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
