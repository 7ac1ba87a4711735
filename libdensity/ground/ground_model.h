#pragma once

#include <map>
#include <optional>

#include "rayfield/core/grid2.h"
#include "rayfield/tile/segments.h"

namespace rayfield::density {

/// Height of the ground over the block: one raster of node heights per tile. Nodes lie at the cell *corners*, so that
/// neighbouring tiles share the nodes on their border and bilinear interpolation has no seam.
class GroundModel {
 public:
  GroundModel() = default;
  explicit GroundModel(double tile_size_m) : tile_size_m_(tile_size_m) {}

  /// `nodes`: (n+1)×(n+1) heights, n·cell = tile size, first node on the tile's south-west corner; NaN = unknown.
  void set(tile::TileIndex index, Grid2<float> nodes);
  /// Height at a map point, bilinear between nodes; nullopt where a node is unknown or the tile is absent.
  std::optional<double> height(double easting, double northing) const;
  const std::map<tile::TileIndex, Grid2<float>>& tiles() const { return tiles_; }

 private:
  double tile_size_m_ = 25;
  std::map<tile::TileIndex, Grid2<float>> tiles_;
};

}  // namespace rayfield::density
