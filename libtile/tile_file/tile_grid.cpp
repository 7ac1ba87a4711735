#include "libtile/tile_file/tile_grid.h"

#include <algorithm>
#include <cmath>

namespace rayfield::tile {
namespace {

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  const std::int64_t quotient = a / b;
  return quotient - (a % b < 0 ? 1 : 0);
}

// Up to this many rows of tiles are tried one by one; longer columns are cut to what the ray crosses first.
constexpr std::int64_t kFewRows = 4;

}  // namespace

TileGrid::TileGrid(const StoreConfig& config)
    : size(std::llround(config.tile_size_m * kUnitsPerMetre)),
      margin(std::llround(config.tile_margin_m * kUnitsPerMetre)) {}

TileIndex TileGrid::tile_of(std::int64_t x, std::int64_t y) const {
  return {static_cast<std::int32_t>(floor_divide(x, size)), static_cast<std::int32_t>(floor_divide(y, size))};
}

LocalRay TileGrid::local(const MapRay& ray, TileIndex tile) const {
  return {{static_cast<std::int32_t>(ray.origin[0] - tile.ix * size),
           static_cast<std::int32_t>(ray.origin[1] - tile.iy * size), static_cast<std::int32_t>(ray.origin[2])},
          ray.ray};
}

std::uint8_t segment_flags(const LocalRay& ray, const TileGrid& grid, bool hit) {
  const std::int64_t ox = ray.origin[0], oy = ray.origin[1];
  const std::int64_t ex = ox + ray.ray[0], ey = oy + ray.ray[1];
  unsigned flags = 0;
  if (inside(ox, oy, 0, grid.size - 1)) flags |= kStartsHere;
  if (inside(ex, ey, 0, grid.size - 1)) flags |= kEndsHere;
  if (hit && inside(ex, ey, grid.low(), grid.high())) flags |= kHit;
  return static_cast<std::uint8_t>(flags);
}

// Goes through the columns of tiles that the ray's box touches. Long columns are first cut to the rows that the ray can
// reach within the column; whether a tile is kept is then decided by the same clipping that readers apply.
void TileGrid::tiles_of(const MapRay& ray, std::vector<TileIndex>& tiles) const {
  tiles.clear();
  const auto reach = [&](std::size_t k) {
    const std::int64_t a = ray.origin[k], b = a + ray.ray[k];
    return std::pair(floor_divide(std::min(a, b) - margin, size), floor_divide(std::max(a, b) + margin, size));
  };
  const auto [x_first, x_last] = reach(0);
  const auto [y_first, y_last] = reach(1);
  const double ox = static_cast<double>(ray.origin[0]), oy = static_cast<double>(ray.origin[1]);
  const double dx = ray.ray[0], dy = ray.ray[1];
  for (std::int64_t ix = x_first; ix <= x_last; ++ix) {
    std::int64_t first = y_first, last = y_last;
    if (last - first >= kFewRows && ray.ray[0] != 0) {
      const double west = (static_cast<double>(ix * size - margin) - ox) / dx;
      const double east = (static_cast<double>((ix + 1) * size + margin) - ox) / dx;
      const double y0 = oy + std::clamp(std::min(west, east), 0.0, 1.0) * dy;
      const double y1 = oy + std::clamp(std::max(west, east), 0.0, 1.0) * dy;
      // Two units of slack are more than these few roundings can lose.
      first = std::max(first, floor_divide(static_cast<std::int64_t>(std::min(y0, y1)) - 2 - margin, size));
      last = std::min(last, floor_divide(static_cast<std::int64_t>(std::max(y0, y1)) + 2 + margin, size));
    }
    for (std::int64_t iy = first; iy <= last; ++iy) {
      const TileIndex tile{static_cast<std::int32_t>(ix), static_cast<std::int32_t>(iy)};
      const LocalRay in_tile = local(ray, tile);
      ClipRange range;
      if (clip(in_tile, low(), high(), range) && keep_segment(range, segment_flags(in_tile, *this, false)))
        tiles.push_back(tile);
    }
  }
}

}  // namespace rayfield::tile
