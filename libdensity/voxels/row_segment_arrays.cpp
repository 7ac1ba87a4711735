#include "libdensity/voxels/row_segment_arrays.h"

#include <array>
#include <cmath>

#include "libdensity/tiles/stored.h"

namespace rayfield::density {
namespace {

constexpr std::array<const char*, 6> kCounts{"row", "index", "first_along", "n_along", "n_across", "n_up"};
constexpr std::array<const char*, 11> kNumbers{"easting_m",    "northing_m", "direction_east", "direction_north",
                                               "chainage_m",   "ground_m",   "slope_along",    "slope_across",
                                               "across_min_m", "up_min_m",   "voxel_m"};
constexpr std::array<const char*, 7> kExtents{"extent_across_low_m", "extent_across_high_m", "extent_up_high_m",
                                              "extent_across_min_m", "extent_across_max_m",  "extent_up_max_m",
                                              "extent_outside_share"};

void put_extents(const std::vector<RowExtents>& extents, tile::ArraySet& out) {
  std::vector<std::int32_t> row;
  std::vector<std::int64_t> hits;
  std::array<std::vector<double>, kExtents.size()> numbers;
  for (const RowExtents& e : extents) {
    row.push_back(e.row), hits.push_back(e.hits);
    const std::array<double, kExtents.size()> values{e.across_low_m, e.across_high_m, e.up_high_m,    e.across_min_m,
                                                     e.across_max_m, e.up_max_m,      e.outside_share};
    for (std::size_t k = 0; k < values.size(); ++k) numbers[k].push_back(values[k]);
  }
  out.columns["extent_row"] = std::move(row), out.columns["extent_hits"] = std::move(hits);
  for (std::size_t k = 0; k < kExtents.size(); ++k) out.columns[kExtents[k]] = std::move(numbers[k]);
}

Result<std::vector<RowExtents>> get_extents(const tile::ArraySet& arrays) {
  RAYFIELD_ASSIGN(const auto row, arrays.column<std::int32_t>("extent_row"));
  RAYFIELD_ASSIGN(const auto hits, stored_column<std::int64_t>(arrays, "extent_hits", row.size()));
  std::array<std::span<const double>, kExtents.size()> v;
  for (std::size_t k = 0; k < kExtents.size(); ++k) {
    RAYFIELD_ASSIGN(v[k], stored_column<double>(arrays, kExtents[k], row.size()));
  }
  std::vector<RowExtents> extents;
  for (std::size_t i = 0; i < row.size(); ++i)
    extents.push_back({row[i], hits[i], v[0][i], v[1][i], v[2][i], v[3][i], v[4][i], v[5][i], v[6][i]});
  return extents;
}

/// Further than anything can be that `process` makes.
constexpr double kFarthestM = 1e8, kFarthestFromRowM = 1000, kLargestVoxelM = 10;

/// A stored file may come from a stranger.
Result<void> check(const RowSegment& s, const tile::ArraySet& arrays) {
  const std::int64_t columns = std::int64_t{s.n_along} * s.n_across;
  if (s.n_along < 1 || s.n_across < 1 || s.n_up < 1 || !(s.voxel_m > 0))
    return damaged(arrays, "a row segment without voxels");
  if (columns > kMostVoxels || columns * s.n_up > kMostVoxels)
    return damaged(arrays, "a row segment with more voxels than a row has");
  const auto within = [](double value, double limit) { return std::abs(value) <= limit; };  // false for NaN
  if (!within(s.origin.x(), kFarthestM) || !within(s.origin.y(), kFarthestM) ||
      !(std::abs(s.direction.norm() - 1) < 1e-6) || !within(s.chainage_m, kFarthestM) ||
      !within(s.ground_m, kFarthestM) || !within(s.slope_along, kFarthestFromRowM) ||
      !within(s.slope_across, kFarthestFromRowM) || !within(s.across_min_m, kFarthestFromRowM) ||
      !within(s.up_min_m, kFarthestFromRowM) || !(s.voxel_m <= kLargestVoxelM))
    return damaged(arrays, "a row segment where none can be");
  return {};
}

}  // namespace

tile::ArraySet row_segments_to_arrays(const RowSegmentList& list) {
  tile::ArraySet out;
  out.kind = "stretches", out.version = 1, out.attributes = nlohmann::json{{"unit", "m"}}.dump();
  std::array<std::vector<std::int32_t>, kCounts.size()> counts;
  std::array<std::vector<double>, kNumbers.size()> numbers;
  for (const RowSegment& s : list.row_segments) {
    const std::array<int, kCounts.size()> c{s.row, s.index, s.first_along, s.n_along, s.n_across, s.n_up};
    const std::array<double, kNumbers.size()> d{s.origin.x(),   s.origin.y(), s.direction.x(), s.direction.y(),
                                                s.chainage_m,   s.ground_m,   s.slope_along,   s.slope_across,
                                                s.across_min_m, s.up_min_m,   s.voxel_m};
    for (std::size_t k = 0; k < c.size(); ++k) counts[k].push_back(c[k]);
    for (std::size_t k = 0; k < d.size(); ++k) numbers[k].push_back(d[k]);
  }
  for (std::size_t k = 0; k < kCounts.size(); ++k) out.columns[kCounts[k]] = std::move(counts[k]);
  for (std::size_t k = 0; k < kNumbers.size(); ++k) out.columns[kNumbers[k]] = std::move(numbers[k]);
  put_extents(list.extents, out);
  return out;
}

Result<RowSegmentList> row_segments_from_arrays(const tile::ArraySet& arrays) {
  RAYFIELD_CHECK(stored_attributes(arrays, "stretches", 1));
  RAYFIELD_ASSIGN(const auto row, arrays.column<std::int32_t>("row"));
  std::array<std::span<const std::int32_t>, kCounts.size()> c;
  std::array<std::span<const double>, kNumbers.size()> d;
  for (std::size_t k = 0; k < kCounts.size(); ++k) {
    RAYFIELD_ASSIGN(c[k], stored_column<std::int32_t>(arrays, kCounts[k], row.size()));
  }
  for (std::size_t k = 0; k < kNumbers.size(); ++k) {
    RAYFIELD_ASSIGN(d[k], stored_column<double>(arrays, kNumbers[k], row.size()));
  }
  RowSegmentList list;
  for (std::size_t i = 0; i < row.size(); ++i) {
    RowSegment s;
    s.row = c[0][i], s.index = c[1][i], s.first_along = c[2][i], s.n_along = c[3][i], s.n_across = c[4][i],
    s.n_up = c[5][i];
    s.origin = {d[0][i], d[1][i]}, s.direction = {d[2][i], d[3][i]}, s.chainage_m = d[4][i], s.ground_m = d[5][i];
    s.slope_along = d[6][i], s.slope_across = d[7][i], s.across_min_m = d[8][i], s.up_min_m = d[9][i],
    s.voxel_m = d[10][i];
    RAYFIELD_CHECK(check(s, arrays));
    list.row_segments.push_back(s);
  }
  RAYFIELD_ASSIGN(list.extents, get_extents(arrays));
  return list;
}

}  // namespace rayfield::density
