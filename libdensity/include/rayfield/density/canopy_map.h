#pragma once

#include <array>
#include <cstdint>
#include <map>

#include "rayfield/core/grid2.h"
#include "rayfield/core/result.h"
#include "rayfield/density/ground_model.h"
#include "rayfield/tile/segments.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// Hits in plan, by height above the ground: what rows are found in.
struct CanopyMapOptions {
  double cell_m = 0.10;      ///< 0.02…0.5, rounded so that a tile holds a whole number of cells
  double stem_min_m = 0.15;  ///< layer `stem`: trunks and posts below the canopy
  double canopy_min_m = 0.60;
  double canopy_max_m = 2.60;
  double tall_min_m = 4.50;  ///< layer `tall`: trees, sheds
  double tall_max_m = 12.0;
  Result<void> validate() const;
};

enum class CanopyLayer { stem, canopy, tall };

/// Hits per cell of one tile and layer, saturating at 255.
struct CanopyTile {
  std::array<Grid2<std::uint8_t>, 3> layers;  ///< by CanopyLayer
};

/// Collects a CanopyTile; order of segments and merges does not matter.
class CanopyAccumulator {
 public:
  /// `ground` must outlive the accumulator. Hits above unknown ground are left out.
  CanopyAccumulator(tile::TileIndex index, double tile_size_m, const GroundModel& ground,
                    const CanopyMapOptions& options);
  void add(const tile::SegmentBatch& segments);
  void merge(const CanopyAccumulator& other);
  const CanopyTile& finish() const { return tile_; }

 private:
  const GroundModel* ground_;
  CanopyMapOptions options_;
  CanopyTile tile_;
};

Result<CanopyTile> canopy_of_tile(const tile::Store::TileReader& reader, tile::TileIndex index, double tile_size_m,
                                  const GroundModel& ground, const CanopyMapOptions& options, int threads);

/// The canopy maps of all tiles, read at map points. About 0.19 MB per tile of 25 m.
class CanopyMap {
 public:
  explicit CanopyMap(double tile_size_m) : tile_size_m_(tile_size_m) {}
  void set(tile::TileIndex index, CanopyTile tile);
  /// Hits in the cell around a map point; 0 where there is no tile.
  int hits(CanopyLayer layer, const Eigen::Vector2d& p_in_map) const;

 private:
  double tile_size_m_;
  std::map<tile::TileIndex, CanopyTile> tiles_;
};

}  // namespace rayfield::density
