#include "libtile/partition/clip_batch.h"

#include <algorithm>
#include <cmath>

namespace rayfield::tile {
namespace {

constexpr double kMaxTime_s = 1e11;  // some three thousand years from the epoch; keeps microseconds in 64 bits

bool in_range(const Eigen::Vector3d& p) {
  return std::abs(p.x()) <= kMaxCoordinate_m && std::abs(p.y()) <= kMaxCoordinate_m && std::abs(p.z()) <= kMaxHeight_m;
}

// Rounds a ray to units; counts and refuses what cannot be one.
bool quantize(const Eigen::Vector3d& origin, const Eigen::Vector3d& end, double time_s, MapRay& ray,
              RayStatistics& statistics) {
  if (!origin.allFinite() || !end.allFinite() || !std::isfinite(time_s)) {
    ++statistics.not_finite;
    return false;
  }
  if (!in_range(origin) || !in_range(end) || std::abs(time_s) > kMaxTime_s) {
    ++statistics.out_of_range;
    return false;
  }
  if ((end - origin).squaredNorm() > kMaxRayLength_m * kMaxRayLength_m) {
    ++statistics.too_long;
    return false;
  }
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    ray.origin[i] = std::llrint(origin[k] * kUnitsPerMetre);
    ray.ray[i] = static_cast<std::int32_t>(std::llrint(end[k] * kUnitsPerMetre) - ray.origin[i]);
  }
  return true;
}

}  // namespace

void RayStatistics::add(const MapRay& ray, std::int64_t time_us, bool hit) {
  if (rays == 0) {
    first = ray;
    origin_min = origin_max = ray.origin;
  }
  ++rays;
  if (hit) ++hits;
  first_time_us = std::min(first_time_us, time_us);
  last_time_us = std::max(last_time_us, time_us);
  for (std::size_t k = 0; k < 3; ++k) {
    origin_min[k] = std::min(origin_min[k], ray.origin[k]);
    origin_max[k] = std::max(origin_max[k], ray.origin[k]);
  }
  any_length = any_length || ray.ray != std::array<std::int32_t, 3>{};
  all_identical = all_identical && ray == *first;
}

void RayStatistics::merge(const RayStatistics& other) {
  not_finite += other.not_finite, out_of_range += other.out_of_range, too_long += other.too_long;
  if (other.rays == 0) return;
  if (rays == 0) {
    first = other.first;
    origin_min = other.origin_min, origin_max = other.origin_max;
  }
  rays += other.rays, hits += other.hits;
  first_time_us = std::min(first_time_us, other.first_time_us);
  last_time_us = std::max(last_time_us, other.last_time_us);
  for (std::size_t k = 0; k < 3; ++k) {
    origin_min[k] = std::min(origin_min[k], other.origin_min[k]);
    origin_max[k] = std::max(origin_max[k], other.origin_max[k]);
  }
  any_length = any_length || other.any_length;
  all_identical = all_identical && other.all_identical && *first == *other.first;
}

std::uint32_t BatchClipper::local_number(TileIndex tile) {
  const auto [it, is_new] = numbers_.try_emplace(tile_key(tile), static_cast<std::uint32_t>(tiles_.size()));
  if (is_new) tiles_.push_back(tile);
  return it->second;
}

void BatchClipper::clip(const RayBatch& batch, std::size_t first_ray, const ClipLimits& limits, ClippedBatch& out) {
  out.statistics = RayStatistics{};
  unsorted_.clear(), tile_of_record_.clear(), tiles_.clear(), numbers_.clear();
  std::size_t i = first_ray;
  for (; i < batch.size() && unsorted_.size() < limits.records && tiles_.size() < limits.groups; ++i) {
    MapRay ray{};
    if (!quantize(batch.origin[i], batch.end[i], batch.time_s[i], ray, out.statistics)) continue;
    const std::int64_t time_us = std::llrint(batch.time_s[i] * 1e6);
    const bool hit = batch.hit[i] != 0;
    out.statistics.add(ray, time_us, hit);
    grid_.tiles_of(ray, crossed_);
    for (const TileIndex tile : crossed_) {
      RayRecord record{};
      record.geometry = grid_.local(ray, tile);
      record.time_low = static_cast<std::uint32_t>(static_cast<std::uint64_t>(time_us));
      record.time_high = static_cast<std::uint32_t>(static_cast<std::uint64_t>(time_us) >> 32U);
      record.flags = segment_flags(record.geometry, grid_, hit);
      record.intensity = (record.flags & kHit) != 0 ? batch.intensity[i] : std::uint16_t{0};
      unsorted_.push_back(record);
      tile_of_record_.push_back(local_number(tile));
    }
  }
  out.next_ray = i;
  group(out);
}

// Counting sort by tile; stable, so that each tile keeps the order of the scan.
void BatchClipper::group(ClippedBatch& out) {
  out.groups.assign(tiles_.size(), {});
  for (const std::uint32_t tile : tile_of_record_) ++out.groups[tile].count;
  std::size_t begin = 0;
  std::vector<std::size_t> next(tiles_.size());
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    out.groups[t].tile = tiles_[t];
    out.groups[t].begin = next[t] = begin;
    begin += out.groups[t].count;
  }
  out.records.resize(unsorted_.size());
  for (std::size_t r = 0; r < unsorted_.size(); ++r) out.records[next[tile_of_record_[r]]++] = unsorted_[r];
}

}  // namespace rayfield::tile
