#include "libdensity/rows/canopy_map.h"
#include "libdensity/tiles/rounding.h"

#include <algorithm>
#include <utility>

namespace rayfield::density {
namespace {

int cells_per_side(double tile_size_m, const CanopyMapOptions& options) {
  return std::max(1, round_int(tile_size_m / options.cell_m));
}

}  // namespace

CanopyAccumulator::CanopyAccumulator(const tile::TileRef& tile, const GroundModel& ground,
                                     const CanopyMapOptions& options)
    : ground_(&ground), options_(options) {
  const int n = cells_per_side(tile.size_m, options);
  tile_.layers.fill(Grid2<std::uint8_t>(tile.corner(), tile.size_m / n, n, n));
}

void CanopyAccumulator::add(const tile::HitBatch& hits) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if ((hits.flags[i] & tile::kEndsHere) == 0) continue;
    const Eigen::Vector3d& p = hits.end[i];
    const auto ground = ground_->height(p.x(), p.y());
    if (!ground) continue;
    const double up = p.z() - *ground;
    CanopyLayer layer = CanopyLayer::tall;
    if (up >= options_.stem_min_m && up < options_.canopy_min_m) {
      layer = CanopyLayer::stem;
    } else if (up >= options_.canopy_min_m && up < options_.canopy_max_m) {
      layer = CanopyLayer::canopy;
    } else if (!(up >= options_.tall_min_m && up < options_.tall_max_m)) {
      continue;
    }
    auto& grid = tile_.layers[static_cast<std::size_t>(layer)];
    const int ix = std::clamp(static_cast<int>((p.x() - grid.origin.x()) / grid.cell_m), 0, grid.nx - 1);
    const int iy = std::clamp(static_cast<int>((p.y() - grid.origin.y()) / grid.cell_m), 0, grid.ny - 1);
    std::uint8_t& cell = grid.at(ix, iy);
    if (cell < 255) ++cell;
  }
}

void CanopyAccumulator::merge(const CanopyAccumulator& other) {
  for (std::size_t l = 0; l < tile_.layers.size(); ++l) {
    std::vector<std::uint8_t>& mine = tile_.layers[l].values;
    const std::vector<std::uint8_t>& theirs = other.tile_.layers[l].values;
    for (std::size_t i = 0; i < mine.size(); ++i)
      mine[i] = static_cast<std::uint8_t>(std::min(255, mine[i] + theirs[i]));
  }
}

std::size_t CanopyMap::tile_bytes(double tile_size_m, const CanopyMapOptions& options) {
  const auto n = static_cast<std::size_t>(cells_per_side(tile_size_m, options));
  return sizeof(CanopyTile) + CanopyTile().layers.size() * n * n;
}

void CanopyMap::set(tile::TileIndex index, CanopyTile tile) { tiles_[index] = std::move(tile); }

int CanopyMap::hits(CanopyLayer layer, const Eigen::Vector2d& p) const {
  const auto it = tiles_.find({floor_int(p.x() / tile_size_m_), floor_int(p.y() / tile_size_m_)});
  if (it == tiles_.end()) return 0;
  const auto& grid = it->second.layers[static_cast<std::size_t>(layer)];
  const int ix = std::clamp(static_cast<int>((p.x() - grid.origin.x()) / grid.cell_m), 0, grid.nx - 1);
  const int iy = std::clamp(static_cast<int>((p.y() - grid.origin.y()) / grid.cell_m), 0, grid.ny - 1);
  return grid.at(ix, iy);
}

}  // namespace rayfield::density
