#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rayfield/tile/segments.h"
#include "rayfield/tile/store_config.h"

/// Geometry in integers. Map coordinates are rounded once to 0.1 mm; which tile a point belongs to, and which tiles a
/// ray crosses, is then decided on the same integers when tiles are written and when they are read.
namespace rayfield::tile {

inline constexpr double kUnitsPerMetre = 1e4;
inline constexpr double kMaxCoordinate_m = 1e8;  ///< easting and northing beyond this belong to no projected CRS
inline constexpr double kMaxHeight_m = 1e5;      ///< keeps heights in 32 bits
inline constexpr double kMaxRayLength_m = 5e3;   ///< no lidar reaches further; keeps rays in 32 bits

/// A tile's index as one number, for hash maps.
inline std::uint64_t tile_key(TileIndex tile) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(tile.ix)) << 32U) | static_cast<std::uint32_t>(tile.iy);
}

/// A ray in units of 0.1 mm, relative to the south-west corner of a tile (heights to 0). `ray` = end − origin.
struct LocalRay {
  std::array<std::int32_t, 3> origin, ray;
};

/// A ray in units of 0.1 mm in the map.
struct MapRay {
  std::array<std::int64_t, 3> origin;
  std::array<std::int32_t, 3> ray;
  bool operator==(const MapRay&) const = default;
};

/// Size and margin of tiles in units.
struct TileGrid {
  std::int64_t size = 250000, margin = 2500;
  explicit TileGrid(const StoreConfig& config);

  TileIndex tile_of(std::int64_t x, std::int64_t y) const;
  LocalRay local(const MapRay& ray, TileIndex tile) const;
  /// Faces of the widened tile in its own coordinates.
  std::int32_t low() const { return static_cast<std::int32_t>(-margin); }
  std::int32_t high() const { return static_cast<std::int32_t>(size + margin); }

  /// Replaces `tiles` by those whose file must hold a segment of the ray (see keep_segment), ordered by (ix, iy).
  void tiles_of(const MapRay& ray, std::vector<TileIndex>& tiles) const;
};

/// The part of a ray inside a widened tile: parameters along the ray, 0 ≤ begin ≤ end ≤ 1.
struct ClipRange {
  double begin = 0, end = 1;
};

/// Clips in plan to the closed square [low, high]²; false where they do not meet. A ray that begins (ends) inside has
/// begin = 0 (end = 1) exactly.
inline bool clip(const LocalRay& ray, std::int32_t low, std::int32_t high, ClipRange& range) {
  range = ClipRange{};
  for (std::size_t k = 0; k < 2; ++k) {
    const std::int32_t d = ray.ray[k];
    const std::int32_t o = ray.origin[k];
    if (d == 0) {
      if (o < low || o > high) return false;
      continue;
    }
    const double to_low = (static_cast<double>(low) - o) / d, to_high = (static_cast<double>(high) - o) / d;
    const double enter = d > 0 ? to_low : to_high, leave = d > 0 ? to_high : to_low;
    if (enter > range.begin) range.begin = enter;
    if (leave < range.end) range.end = leave;
  }
  return range.begin <= range.end;
}

inline bool inside(std::int64_t x, std::int64_t y, std::int64_t low, std::int64_t high) {
  return x >= low && x <= high && y >= low && y <= high;
}

/// SegmentFlag bits of a ray in a tile of that size whose widened square it meets.
std::uint8_t segment_flags(const LocalRay& ray, const TileGrid& grid, bool hit);

/// Whether a ray that meets the closed widened tile leaves a segment there: not where it only touches the rim.
inline bool keep_segment(const ClipRange& range, std::uint8_t flags) {
  return range.begin < range.end || (flags & (kStartsHere | kEndsHere)) != 0;
}

}  // namespace rayfield::tile
