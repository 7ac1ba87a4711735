#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "libtile/tile_file/chunk_codec.h"
#include "libtile/tile_file/tile_grid.h"
#include "rayfield/core/ray.h"

namespace rayfield::tile {

/// What is known of the rays of a scan, independent of how they were grouped into batches.
struct RayStatistics {
  std::uint64_t rays = 0, hits = 0;
  std::uint64_t not_finite = 0, out_of_range = 0, too_long = 0;  ///< dropped, by reason
  std::int64_t first_time_us = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_time_us = std::numeric_limits<std::int64_t>::min();
  std::array<std::int64_t, 3> origin_min{}, origin_max{};  ///< units; of no meaning while rays == 0
  bool any_length = false;                                 ///< a ray with different ends was seen
  bool all_identical = true;                               ///< every ray so far equals `first`
  std::optional<MapRay> first;

  std::uint64_t dropped() const { return not_finite + out_of_range + too_long; }
  void add(const MapRay& ray, std::int64_t time_us, bool hit);
  void merge(const RayStatistics& other);
};

/// Bounds on one round of clipping, whatever the rays look like.
struct ClipLimits {
  std::size_t records = std::size_t{1} << 17;
  std::size_t groups = std::size_t{1} << 12;
};

/// Records of one tile within a clipped batch, in the order of the scan.
struct ClippedGroup {
  TileIndex tile;
  std::size_t begin = 0, count = 0;
};

struct ClippedBatch {
  std::vector<RayRecord> records;
  std::vector<ClippedGroup> groups;
  RayStatistics statistics;
  std::size_t next_ray = 0;  ///< the batch is done when this is its size
};

/// Quantizes rays, drops those that make no sense, and cuts them at tile borders. One object per thread.
class BatchClipper {
 public:
  explicit BatchClipper(const TileGrid& grid) : grid_(grid) {}

  /// Clips rays first_ray … of the batch until it ends or a limit is reached (exceeded by at most one ray).
  void clip(const RayBatch& batch, std::size_t first_ray, const ClipLimits& limits, ClippedBatch& out);

 private:
  std::uint32_t local_number(TileIndex tile);
  void group(ClippedBatch& out);

  TileGrid grid_;
  std::vector<TileIndex> crossed_, tiles_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
  std::vector<RayRecord> unsorted_;
  std::vector<std::uint32_t> tile_of_record_;
};

}  // namespace rayfield::tile
