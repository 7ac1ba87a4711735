#include "libdensity/leaf_angles/direction_counters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "tests/libdensity/voxel_worlds.h"

namespace rayfield::density {
namespace {

/// Length in all voxels together, m, and hits, of one ray along the row: 20 voxels of 12 cm.
struct Counted {
  double path_m = 0;
  std::int64_t hits = 0;
};

Counted count_along_row(const std::shared_ptr<const BeamView>& view, double hit_at) {
  const RowSegment s = testing::make_row_segment();
  tile::SegmentBatch rays;
  testing::push_ray(rays, testing::map_from_grid(s, {-5, 4.5, 3.5}), testing::map_from_grid(s, {hit_at, 4.5, 3.5}),
                    true);
  rays.intensity[0] = 100;
  auto accumulator = VoxelAccumulator::create({testing::kBigTile, testing::kBigTileSize}, std::vector{s}, {},
                                              testing::count_every_ray(), view);
  accumulator->count_directions_only(0, 1);
  EXPECT_TRUE(accumulator->add(rays).has_value());
  const TileVoxels voxels = std::move(*accumulator).finish();
  Counted out;
  for (const DirectionCounters& d : voxels.row_segments[0].directions) {
    out.path_m += s.voxel_m * DirectionCounters::kPathUnit *
                  static_cast<double>(std::accumulate(d.path.begin(), d.path.end(), std::int64_t{0}));
    out.hits += std::accumulate(d.hits.begin(), d.hits.end(), std::int64_t{0});
  }
  return out;
}

// Deeper in they have lost more of themselves, and level rays come deeper than steep ones.
TEST(DirectionCounters, WideBeamsAreLookedAtWhereTheyComeIn) {
  const Eigen::Vector3d sensor = testing::map_from_grid(testing::make_row_segment(), {-5, 4.5, 3.5});
  const auto wide =
      std::make_shared<const BeamView>(BeamView{{0.02, 0.002, {}}, 0.12, SensorTrack({{0, sensor}}), 100});
  const double slant = std::hypot(1, 0.06);  // the ground rises along the row
  const Counted thin = count_along_row(nullptr, 18.5), all = count_along_row(wide, 10.5),
                some = count_along_row(wide, 18.5);
  EXPECT_NEAR(thin.path_m, 18.5 * 0.12 * slant, 0.002);
  EXPECT_EQ(thin.hits, 1);
  EXPECT_NEAR(all.path_m, 10.5 * 0.12 * slant, 0.002);
  EXPECT_EQ(all.hits, 100);
  EXPECT_NEAR(some.path_m, 1.5, 0.002);
  EXPECT_EQ(some.hits, 0);
}

}  // namespace
}  // namespace rayfield::density
