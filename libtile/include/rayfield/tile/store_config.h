#pragma once

#include <string>

#include "rayfield/core/result.h"

namespace rayfield::tile {

/// What a store is made with, once (store.json).
struct StoreConfig {
  std::string crs;              ///< projected CRS in metres, e.g. "EPSG:7854"
  double tile_size_m = 25.0;    ///< side of a tile; smaller tiles: less memory per task, more files
  double tile_margin_m = 0.25;  ///< how far a tile file reaches over its border; bounds the voxel size to margin·√2
  Result<void> validate() const;
};

}  // namespace rayfield::tile
