#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <vector>

namespace rayfield::tile {

/// Which square of the map: it covers [ix·size, (ix+1)·size) × [iy·size, (iy+1)·size) in map metres.
struct TileIndex {
  std::int32_t ix = 0, iy = 0;
  auto operator<=>(const TileIndex&) const = default;
};

/// One square of the map with the store's tile size.
struct TileRef {
  TileIndex index;
  double size_m = 0;

  /// South-west corner, m.
  Eigen::Vector2d corner() const { return {index.ix * size_m, index.iy * size_m}; }
};

/// Which part of its ray a segment holds.
enum SegmentFlag : std::uint8_t {
  kHit = 1,         ///< the ray hit a surface at this segment's end (set only where that end belongs to this file)
  kStartsHere = 2,  ///< the ray's origin lies in the tile proper: over all tiles, each ray has this flag exactly once
  kEndsHere = 4,    ///< the ray's end lies in the tile proper: over all tiles, each ray has this flag exactly once
};

/// Rays clipped to a tile *and its margin*, decoded, in map coordinates; in the order of the scan.
///
/// A tile file keeps each ray's path through the tile widened by StoreConfig::tile_margin_m on all sides, so that any
/// voxel whose centre lies in the tile (and whose half diagonal in plan is below the margin) sees the whole path of
/// every ray through it: counters per voxel need no second file and count a ray once. A segment with kHit ends at the
/// surface; it may lie in the margin, in which case the neighbour has the hit too, with kEndsHere there.
struct SegmentBatch {
  std::vector<Eigen::Vector3d> entry;    ///< where the ray enters the widened tile, or its origin; m
  std::vector<Eigen::Vector3d> exit;     ///< where it leaves the widened tile, or its end; m
  std::vector<double> time_s;            ///< Unix time, s
  std::vector<std::uint16_t> intensity;  ///< 0 unless kHit
  std::vector<std::uint8_t> flags;       ///< SegmentFlag bits

  std::size_t size() const { return entry.size(); }
  bool empty() const { return entry.empty(); }
};

/// Of the segments with kHit where they end: enough wherever free space does not matter, and much faster to have.
struct HitBatch {
  std::vector<Eigen::Vector3d> end;  ///< m
  std::vector<std::uint8_t> flags;   ///< SegmentFlag bits

  std::size_t size() const { return end.size(); }
};

}  // namespace rayfield::tile
