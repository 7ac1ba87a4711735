#pragma once

#include <array>
#include <cstdint>
#include <map>

#include "libdensity/ground/ground_model.h"
#include "rayfield/core/grid2.h"
#include "rayfield/core/result.h"
#include "rayfield/density/layout_options.h"
#include "rayfield/tile/segments.h"

namespace rayfield::density {

enum class CanopyLayer { stem, canopy, tall };

/// Hits per cell of one tile and layer, saturating at 255.
struct CanopyTile {
  std::array<Grid2<std::uint8_t>, 3> layers;  ///< by CanopyLayer
};

/// Collects a CanopyTile; order of segments and merges does not matter.
class CanopyAccumulator {
 public:
  /// `ground` must outlive the accumulator. Hits above unknown ground are left out.
  CanopyAccumulator(const tile::TileRef& tile, const GroundModel& ground, const CanopyMapOptions& options);
  void add(const tile::HitBatch& hits);
  void merge(const CanopyAccumulator& other);
  const CanopyTile& finish() const { return tile_; }

 private:
  const GroundModel* ground_;
  CanopyMapOptions options_;
  CanopyTile tile_;
};

/// The canopy maps of all tiles, read at map points. About 0.19 MB per tile of 25 m.
class CanopyMap {
 public:
  explicit CanopyMap(double tile_size_m) : tile_size_m_(tile_size_m) {}
  /// Memory that the map of one tile takes.
  static std::size_t tile_bytes(double tile_size_m, const CanopyMapOptions& options);
  void set(tile::TileIndex index, CanopyTile tile);
  /// Hits in the cell around a map point; 0 where there is no tile.
  int hits(CanopyLayer layer, const Eigen::Vector2d& p_in_map) const;

 private:
  double tile_size_m_;
  std::map<tile::TileIndex, CanopyTile> tiles_;
};

}  // namespace rayfield::density
