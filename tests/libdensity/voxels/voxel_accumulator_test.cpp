#include "libdensity/voxels/voxel_accumulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/libdensity/voxel_worlds.h"

namespace rayfield::density {
namespace {

using Eigen::Vector3d;
using testing::clipped_path;
using testing::count_all;
using testing::make_row_segment;
using testing::push_ray;
using testing::random_rays;

TEST(VoxelAccumulator, PathsAndCountsAreThoseOfEveryVoxelClippedByItself) {
  const RowSegment s = make_row_segment();
  const tile::SegmentBatch rays = random_rays(s, 400, 1);
  const TileVoxels voxels = count_all({s}, rays);
  ASSERT_EQ(voxels.row_segments.size(), 1u);
  for (int a = 0; a < s.n_along; ++a)
    for (int c = 0; c < s.n_across; ++c)
      for (int u = 0; u < s.n_up; ++u) {
        double path = 0, hit_path = 0;
        unsigned n = 0, m = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const double x = clipped_path(s, a, c, u, rays.entry[i], rays.exit[i]) / s.voxel_m;
          if (x <= 1e-9) continue;
          ++n, path += x;
          // The hit lies here if a ray that stops a little earlier has a shorter path here.
          const Vector3d before = rays.exit[i] - 1e-7 * (rays.exit[i] - rays.entry[i]);
          const bool ends = clipped_path(s, a, c, u, rays.entry[i], before) / s.voxel_m < x - 1e-9;
          if (ends && (rays.flags[i] & tile::kHit) != 0) ++m, hit_path += x;
        }
        const VoxelCounters& v = voxels.row_segments[0].column_voxels(a, c)[static_cast<std::size_t>(u)];
        ASSERT_EQ(v.rays, n) << a << " " << c << " " << u;
        ASSERT_EQ(v.hits, m) << a << " " << c << " " << u;
        ASSERT_NEAR(static_cast<double>(v.path) * VoxelCounters::kUnit, path, 1e-6);
        ASSERT_NEAR(static_cast<double>(v.hit_path) * VoxelCounters::kUnit, hit_path, 1e-6);
        ASSERT_GE(v.potential, v.path);
      }
}

TEST(VoxelAccumulator, EveryHitInsideTheGridIsCountedOnce) {
  const RowSegment s = make_row_segment();
  const tile::SegmentBatch rays = random_rays(s, 5000, 2);
  unsigned inside = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Vector3d g = testing::grid_from_map(s, rays.exit[i]);
    if ((rays.flags[i] & tile::kHit) != 0 && (g.array() >= 0).all() && g.x() < s.n_along && g.y() < s.n_across &&
        g.z() < s.n_up)
      ++inside;
  }
  ASSERT_GT(inside, 500u);
  unsigned hits = 0;
  const TileVoxels voxels = count_all({s}, rays);
  for (const VoxelCounters& v : voxels.row_segments[0].voxels) hits += v.hits;
  EXPECT_EQ(hits, inside);
}

TEST(VoxelAccumulator, ColumnsOfNeighbouringTilesAddUpToTheWhole) {
  const RowSegment s = make_row_segment();  // lies across the corner of four tiles of 25 m
  const tile::SegmentBatch rays = random_rays(s, 3000, 3);
  const TileVoxels whole = count_all({s}, rays);
  std::vector<int> owners(whole.row_segments[0].column.size(), 0);
  for (int iy = -1; iy <= 1; ++iy)
    for (int ix = -1; ix <= 1; ++ix) {
      auto accumulator =
          VoxelAccumulator::create({{10 + ix, 20 + iy}, 25.0}, std::vector{s}, {}, testing::count_every_ray());
      ASSERT_TRUE(accumulator.has_value());
      ASSERT_TRUE(accumulator->add(rays).has_value());
      const TileVoxels part = std::move(*accumulator).finish();
      for (const RowSegmentVoxels& block : part.row_segments)
        for (int a = 0; a < s.n_along; ++a)
          for (int c = 0; c < s.n_across; ++c) {
            const auto mine = block.column_voxels(a, c), all = whole.row_segments[0].column_voxels(a, c);
            if (mine.empty()) continue;
            ++owners[static_cast<std::size_t>(a) * static_cast<std::size_t>(s.n_across) + static_cast<std::size_t>(c)];
            EXPECT_TRUE(std::equal(mine.begin(), mine.end(), all.begin()));
          }
    }
  EXPECT_TRUE(std::all_of(owners.begin(), owners.end(), [](int n) { return n == 1; }));
}

TEST(VoxelAccumulator, AnySplitOfTheSegmentsGivesTheSameCounters) {
  const RowSegment s = make_row_segment();
  const tile::SegmentBatch rays = random_rays(s, 3000, 4);
  const TileVoxels whole = count_all({s}, rays);
  auto first = VoxelAccumulator::create({testing::kBigTile, testing::kBigTileSize}, std::vector{s}, {},
                                        testing::count_every_ray());
  ASSERT_TRUE(first.has_value());
  VoxelAccumulator second = *first;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    tile::SegmentBatch one;
    testing::copy_ray(rays, rays.size() - 1 - i, one);
    ASSERT_TRUE((i % 3 == 0 ? *first : second).add(one).has_value());
  }
  ASSERT_TRUE(first->merge(second).has_value());
  const TileVoxels split = std::move(*first).finish();
  EXPECT_EQ(split.row_segments[0].voxels, whole.row_segments[0].voxels);
  EXPECT_EQ(split.row_segments[0].entries, whole.row_segments[0].entries);
}

TEST(VoxelAccumulator, ARayThatStartsInsideCountsInItsFirstVoxel) {
  const RowSegment s = make_row_segment();
  tile::SegmentBatch rays;
  push_ray(rays, testing::map_from_grid(s, {5.5, 4.5, 6.5}), testing::map_from_grid(s, {9.5, 4.5, 6.5}), true);
  const TileVoxels voxels = count_all({s}, rays);
  const auto at = [&](int a) { return voxels.row_segments[0].column_voxels(a, 4)[6]; };
  EXPECT_EQ(at(5).rays, 1u);
  EXPECT_NEAR(static_cast<double>(at(5).path) * VoxelCounters::kUnit,
              0.5 * (rays.exit[0] - rays.entry[0]).norm() / (4 * s.voxel_m), 1e-6);
  EXPECT_EQ(at(9).hits, 1u);
  EXPECT_EQ(at(4).rays, 0u);
  EXPECT_EQ(at(10).rays, 0u);
}

TEST(VoxelAccumulator, EachRayEntersTheRowOnceHoweverManyRowSegmentsAndTilesItCrosses) {
  // Two row segments in line; rays at a small angle to the row pass from one to the other.
  RowSegment a = make_row_segment(), b = a;
  a.n_along = 10;
  b.index = 1, b.first_along = 10, b.n_along = a.n_along;
  b.origin = a.origin + a.n_along * a.voxel_m * a.direction, b.chainage_m = a.chainage_m + a.n_along * a.voxel_m;
  b.ground_m = a.ground_m + a.slope_along * a.n_along * a.voxel_m;
  tile::SegmentBatch rays;
  for (int k = 0; k < 20; ++k)
    push_ray(rays, testing::map_from_grid(a, {2.0 + 0.2 * k, -8.0, 4.5}),
             testing::map_from_grid(a, {14.0 + 0.2 * k, 12.0 + k, 5.5}), false);
  std::uint64_t entries = 0;
  for (int iy = -1; iy <= 1; ++iy)
    for (int ix = -1; ix <= 1; ++ix) {
      auto accumulator = VoxelAccumulator::create({{10 + ix, 20 + iy}, 25.0}, std::vector{a, b}, {}, {});
      ASSERT_TRUE(accumulator.has_value() && accumulator->add(rays).has_value());
      const TileVoxels voxels = std::move(*accumulator).finish();
      for (const RowSegmentVoxels& s : voxels.row_segments)
        for (const std::uint32_t n : s.entries) entries += n;
    }
  EXPECT_EQ(entries, rays.size());
}

TEST(VoxelAccumulator, HitsOnKnownWoodAreNoHitsAndThePathInItsShellIsLeftOut) {
  const RowSegment s = make_row_segment();
  const Vector3d middle = testing::map_from_grid(s, {10.5, s.n_across / 2.0, 0});
  const WoodCylinder post{s.row, {middle.x(), middle.y(), middle.z() - s.up_min_m}, Vector3d::UnitZ(), 0.05, 2.5};
  tile::SegmentBatch rays;  // straight across the row at the post: one stops on it, one misses it
  const auto at = [&](double along, double across) { return testing::map_from_grid(s, {along, across, 5.5}); };
  push_ray(rays, at(10.5, -5), at(10.5, s.n_across / 2.0 - 0.05 / s.voxel_m), true);
  push_ray(rays, at(3.5, -5), at(3.5, s.n_across / 2.0 + 0.3), true);
  VoxelOptions options = testing::count_every_ray();
  options.wood_shell_m = 0.04;
  auto accumulator =
      VoxelAccumulator::create({testing::kBigTile, testing::kBigTileSize}, std::vector{s}, std::vector{post}, options);
  ASSERT_TRUE(accumulator.has_value() && accumulator->add(rays).has_value());
  const TileVoxels voxels = std::move(*accumulator).finish();
  unsigned hits = 0;
  double path = 0;
  for (int c = 0; c < s.n_across; ++c) {
    path += static_cast<double>(voxels.row_segments[0].column_voxels(10, c)[5].path) * VoxelCounters::kUnit * s.voxel_m;
    hits += voxels.row_segments[0].column_voxels(10, c)[5].hits;
    EXPECT_EQ(voxels.row_segments[0].column_voxels(3, c)[5].hits, c == s.n_across / 2 ? 1u : 0u);
  }
  EXPECT_EQ(hits, 0u);
  // True length per metre across the row, times the way to the shell (a circle in the horizontal plane).
  const double slope = (at(10.5, 1) - at(10.5, 0)).norm() / s.voxel_m;
  EXPECT_NEAR(path, slope * (s.n_across / 2.0 * s.voxel_m - 0.09), 1e-5);
}

TEST(VoxelAccumulator, GrazingDownwardRaysAreLeftOutWhetherTheyHitOrNot) {
  const RowSegment s = make_row_segment();  // falls 6 % against its direction
  const Vector3d target = testing::map_from_grid(s, {10.5, 4.5, 6.5});
  const Vector3d along(s.direction.x(), s.direction.y(), 0);
  const auto rays_seen = [&](const Vector3d& direction, double sure_return_m) {
    tile::SegmentBatch rays;
    push_ray(rays, target - 3 * direction, target, true);
    push_ray(rays, target - 3 * direction, target + 30 * direction, true);
    VoxelOptions options;
    options.sure_return_m = sure_return_m;
    auto accumulator =
        VoxelAccumulator::create({testing::kBigTile, testing::kBigTileSize}, std::vector{s}, {}, options);
    EXPECT_TRUE(accumulator.has_value() && accumulator->add(rays).has_value());
    return std::move(*accumulator).finish().row_segments[0].column_voxels(10, 4)[6].rays;
  };
  const Vector3d uphill = along + Vector3d(0, 0, -0.05), downhill = -along + Vector3d(0, 0, -0.05);
  EXPECT_EQ(rays_seen(uphill.normalized(), 25), 2u);    // 11 % against the ground: meets it within 15 m
  EXPECT_EQ(rays_seen(downhill.normalized(), 25), 0u);  // 1 % above the falling ground
  EXPECT_EQ(rays_seen(downhill.normalized(), 0), 2u);
  const Vector3d up = -along + Vector3d(0, 0, 0.01);
  EXPECT_EQ(rays_seen(up.normalized(), 25), 2u);  // would be kept without a return
}

TEST(VoxelAccumulator, LeafAnglesTurnLengthsIntoSphericalEquivalents) {
  const RowSegment s = make_row_segment();
  tile::SegmentBatch rays;
  push_ray(rays, testing::map_from_grid(s, {5.5, 4.5, 40}), testing::map_from_grid(s, {5.5, 4.5, -40}), false);
  VoxelOptions options;
  options.leaf_angles.type = LeafAngleType::planophile;
  auto accumulator = VoxelAccumulator::create({testing::kBigTile, testing::kBigTileSize}, std::vector{s}, {}, options);
  ASSERT_TRUE(accumulator.has_value() && accumulator->add(rays).has_value());
  const TileVoxels voxels = std::move(*accumulator).finish();
  EXPECT_NEAR(static_cast<double>(voxels.row_segments[0].column_voxels(5, 4)[3].path) * VoxelCounters::kUnit,
              2 * 8 / (3 * 3.14159265358979), 2e-3);
}

TEST(VoxelAccumulator, DirectionsAddUpToTheCounters) {
  const RowSegment s = make_row_segment();
  tile::SegmentBatch rays;
  push_ray(rays, testing::map_from_grid(s, {5.5, 4.5, 40}), testing::map_from_grid(s, {5.5, 4.5, 3.5}), true);
  const Vector3d left = testing::map_from_grid(s, {5.5, -40, 3.5}), right = testing::map_from_grid(s, {5.5, 40, 3.5});
  const Vector3d low = left.z() < right.z() ? left : right, high = left.z() < right.z() ? right : left;
  const Vector3d across = (high - low).normalized();  // runs up, so that it is counted
  push_ray(rays, low, high, false);
  auto accumulator = VoxelAccumulator::create({testing::kBigTile, testing::kBigTileSize}, std::vector{s}, {}, {});
  ASSERT_TRUE(accumulator.has_value());
  VoxelAccumulator counting = *accumulator, again = *accumulator;
  ASSERT_TRUE(counting.add(rays) && again.add(rays) && counting.merge(again));
  accumulator->count_directions_only(0, 1);
  VoxelAccumulator other = *accumulator;
  ASSERT_TRUE(accumulator->add(rays) && other.add(rays) && accumulator->merge(other));
  const TileVoxels voxels = std::move(*accumulator).finish(), counted = std::move(counting).finish();
  const RowSegmentVoxels& segment = voxels.row_segments[0];
  EXPECT_TRUE(segment.voxels.empty());
  ASSERT_EQ(segment.directions.size(), counted.row_segments[0].voxels.size());
  for (std::size_t i = 0; i < segment.directions.size(); ++i) {
    std::int64_t path = 0, hits = 0;
    for (std::size_t k = 0; k < DirectionCounters::kBins; ++k)
      path += segment.directions[i].path[k], hits += segment.directions[i].hits[k];
    EXPECT_NEAR(static_cast<double>(path) * DirectionCounters::kPathUnit,
                counted.row_segments[0].voxels[i].path_sides(), 1e-3);
    EXPECT_EQ(hits, counted.row_segments[0].voxels[i].hits);
  }
  const std::size_t steep = DirectionCounters::bin_of(DirectionCounters::steepness_of(1), 0),
                    level = DirectionCounters::bin_of(DirectionCounters::steepness_of(across.z()), 0);
  const std::size_t at =
      static_cast<std::size_t>(segment.column[s.shape().column(5, 4)]) * static_cast<std::size_t>(s.n_up) + 3;
  EXPECT_EQ(segment.directions[at].hits[steep], 2);
  EXPECT_GT(segment.directions[at].path[level], 0);
}

TEST(VoxelAccumulator, NeighbouringBeamsAreNotCountedWhereNobodyAsks) {
  const RowSegment s = make_row_segment();
  tile::SegmentBatch rays;
  for (int i = 0; i < 4; ++i)
    push_ray(rays, testing::map_from_grid(s, {5.5 + 0.1 * i, 4.5, 40}),
             testing::map_from_grid(s, {5.5 + 0.1 * i, 4.5, 3.5}), true);
  auto with_pairs = VoxelAccumulator::create({testing::kBigTile, testing::kBigTileSize}, std::vector{s}, {}, {});
  ASSERT_TRUE(with_pairs.has_value());
  VoxelAccumulator without = *with_pairs;
  without.leave_out_pairs();
  ASSERT_TRUE(with_pairs->add(rays) && without.add(rays));
  const TileVoxels all = std::move(*with_pairs).finish(), fewer = std::move(without).finish();
  EXPECT_EQ(all.row_segments[0].voxels, fewer.row_segments[0].voxels);
  EXPECT_NE(all.pairs, LeafSizePairs{});
  EXPECT_EQ(fewer.pairs, LeafSizePairs{});
}

TEST(VoxelAccumulator, RaysWithoutLengthOrFarAwayChangeNothing) {
  const RowSegment s = make_row_segment();
  tile::SegmentBatch rays;
  const Vector3d inside = testing::map_from_grid(s, {5.5, 4.5, 6.5});
  push_ray(rays, inside, inside, true);
  push_ray(rays, inside + Vector3d(0, 0, 50), inside + Vector3d(10, 0, 60), false);
  push_ray(rays, inside + Vector3d(500, 0, 0), inside + Vector3d(510, 0, 0), true);
  const TileVoxels voxels = count_all({s}, rays);
  for (const VoxelCounters& v : voxels.row_segments[0].voxels) EXPECT_EQ(v, VoxelCounters{});
}

TEST(VoxelAccumulator, ImpossibleRowSegmentsAndOptionsAreRefused) {
  RowSegment s = make_row_segment();
  s.n_up = 0;
  EXPECT_EQ(VoxelAccumulator::create({{}, 25}, std::vector{s}, {}, {}).error().code, ErrorCode::usage);
  s = make_row_segment(), s.voxel_m = 0;
  EXPECT_FALSE(VoxelAccumulator::create({{}, 25}, std::vector{s}, {}, {}).has_value());
  VoxelOptions options;
  options.wood_shell_m = -1;
  EXPECT_FALSE(VoxelAccumulator::create({{}, 25}, std::vector{make_row_segment()}, {}, options).has_value());
}

TEST(VoxelAccumulator, ATileWithoutColumnsIsEmpty) {
  auto accumulator = VoxelAccumulator::create({{0, 0}, 25}, std::vector{make_row_segment()}, {}, {});
  ASSERT_TRUE(accumulator.has_value());
  EXPECT_TRUE(accumulator->empty());
  EXPECT_TRUE(accumulator->add(random_rays(make_row_segment(), 10, 5)).has_value());
}

}  // namespace
}  // namespace rayfield::density
