#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "libdensity/voxels/voxel_accumulator.h"
#include "tests/libdensity/voxel_worlds.h"

namespace rayfield::density {
namespace {

using Eigen::Vector3d;
using testing::clipped_path;
using testing::count_all;
using testing::make_row_segment;
using testing::push_ray;
using testing::random_rays;

/// Beams of a lidar that stands in one place.
std::shared_ptr<const BeamView> view_from(const Vector3d& sensor, const LidarBeam& beam, double behind_m) {
  return std::make_shared<const BeamView>(BeamView{beam, behind_m, SensorTrack({{0, sensor}})});
}

tile::SegmentBatch bright_rays(const RowSegment& s, int count, std::uint64_t seed) {
  tile::SegmentBatch rays = random_rays(s, count, seed);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if ((rays.flags[i] & tile::kHit) != 0) rays.intensity[i] = static_cast<std::uint16_t>(100 + i % 1000);
  return rays;
}

TEST(WideBeamCounters, WideBeamsAddTheirCountersAndChangeNoOthers) {
  const RowSegment s = make_row_segment();
  const tile::SegmentBatch rays = bright_rays(s, 3000, 21);
  const TileVoxels thin = count_all({s}, rays);
  const TileVoxels wide = count_all({s}, rays, {}, view_from(rays.entry[0], {0.01, 0.004, {}}, 0.12));
  EXPECT_EQ(wide.row_segments[0].voxels, thin.row_segments[0].voxels);
  EXPECT_EQ(wide.row_segments[0].entries, thin.row_segments[0].entries);
  EXPECT_EQ(wide.pairs, thin.pairs);
  EXPECT_TRUE(thin.row_segments[0].echoes.empty());
  EXPECT_EQ(wide.row_segments[0].echoes.size(), wide.row_segments[0].voxels.size());
}

TEST(WideBeamCounters, EchoesAndTheWayBehindThemAreThoseOfEveryVoxelClippedByItself) {
  const RowSegment s = make_row_segment();
  const tile::SegmentBatch rays = bright_rays(s, 300, 22);
  constexpr double kBehind = 0.2, kWidth = 0.03;
  const TileVoxels voxels = count_all({s}, rays, {}, view_from({0, 0, 0}, {kWidth, 0, {}}, kBehind));
  for (int a = 0; a < s.n_along; ++a)
    for (int c = 0; c < s.n_across; ++c)
      for (int u = 0; u < s.n_up; ++u) {
        double behind = 0, echo_behind = 0, echo = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
          if ((rays.flags[i] & tile::kHit) == 0) continue;
          const Vector3d way = rays.exit[i] - rays.entry[i], on = rays.exit[i] + kBehind * way.normalized();
          const double x = clipped_path(s, a, c, u, rays.exit[i], on) / s.voxel_m;
          behind += x, echo_behind += x * rays.intensity[i];
          const double here = clipped_path(s, a, c, u, rays.entry[i], rays.exit[i]),
                       before = clipped_path(s, a, c, u, rays.entry[i], rays.exit[i] - 1e-7 * way);
          if (here > 1e-9 && before < here - 1e-9) echo += rays.intensity[i];
        }
        const RowSegmentVoxels& row_segment = voxels.row_segments[0];
        const EchoCounters& e = row_segment.column_echoes(a, c)[static_cast<std::size_t>(u)];
        const VoxelCounters& v = row_segment.column_voxels(a, c)[static_cast<std::size_t>(u)];
        ASSERT_NEAR(static_cast<double>(e.behind) * EchoCounters::kPathUnit, behind, 2e-3);
        ASSERT_NEAR(static_cast<double>(e.echo_behind) * EchoCounters::kPathUnit, echo_behind, 2);
        ASSERT_NEAR(static_cast<double>(e.echo), echo, 0.5) << a << " " << c << " " << u;
        // Beams of the same width everywhere.
        const double width = static_cast<double>(e.width) * EchoCounters::kPathUnit * EchoCounters::kWidthUnitM;
        ASSERT_NEAR(width, kWidth * v.path_sides(), 1e-4 * (1 + v.rays));
      }
}

TEST(WideBeamCounters, WidthGrowsWithRange) {
  RowSegment s = make_row_segment();
  s.slope_along = s.slope_across = 0;
  RowSegment next = s;  // a row behind, and nothing between
  next.row = 2, next.across_min_m = s.across_min_m + 3;
  const auto at = [&](double across) { return testing::map_from_grid(s, {4.5, across / s.voxel_m, 5.5}); };
  tile::SegmentBatch rays;
  push_ray(rays, at(-1), at(6), false);
  const LidarBeam beam{0.01, 0.005, {}};
  const TileVoxels voxels = count_all({s, next}, rays, {}, view_from(at(-2), beam, 0.12));
  ASSERT_EQ(voxels.row_segments.size(), 2u);
  for (int row = 0; row < 2; ++row)
    for (int c = 0; c < s.n_across; ++c) {
      const RowSegmentVoxels& row_segment = voxels.row_segments[static_cast<std::size_t>(row)];
      const EchoCounters& e = row_segment.column_echoes(4, c)[5];
      const double path = row_segment.column_voxels(4, c)[5].path_sides() / EchoCounters::kPathUnit;
      EXPECT_NEAR(static_cast<double>(e.width) / path * EchoCounters::kWidthUnitM,
                  beam.diameter_at(2 + 3 * row + (c + 0.5) * s.voxel_m), 1e-4);
    }
}

// A beam that is followed up to 3 m from the lidar: what lies farther off has not been looked at, and a hit there is
// none.
TEST(WideBeamCounters, BeamsAreFollowedAsFarAsTheViewSays) {
  RowSegment s = make_row_segment();
  s.slope_along = s.slope_across = 0;
  const auto at = [&](double across_sides) { return testing::map_from_grid(s, {4.5, across_sides, 5.5}); };
  const double side = s.voxel_m;
  tile::SegmentBatch rays;
  push_ray(rays, at(-1), at(6.5), true);
  rays.intensity[0] = 500;
  const Vector3d sensor = at(-1) - (2 - 3 * side) * (at(1) - at(0)).normalized();
  const auto counted = [&](double followed_m) {
    BeamView view{{0.01, 0.004, {}}, 0.12, SensorTrack({{0, sensor}})};
    view.followed_m = followed_m;
    return count_all({s}, rays, {}, std::make_shared<const BeamView>(view)).row_segments.at(0);
  };
  // The lidar stands 2 − 3 sides before the ray's beginning: at 2 m the ray is in the middle between columns 1 and 2.
  const RowSegmentVoxels near = counted(2), all = counted(100);
  EXPECT_EQ(all.column_voxels(4, 6)[5].hits, 1u);
  EXPECT_GT(all.column_voxels(4, 3)[5].path, 0);
  for (int c = 0; c < s.n_across; ++c) {
    const VoxelCounters& voxel = near.column_voxels(4, c)[5];
    EXPECT_EQ(voxel.hits, 0u);
    EXPECT_NEAR(voxel.path_sides(), c < 2 ? all.column_voxels(4, c)[5].path_sides() : 0, 1e-3) << c;
  }
  EXPECT_EQ(followed_of({0.0136, 0.0119, {}}, {}), (0.08 - 0.0136) / 0.0119);
  EXPECT_EQ(followed_of({0.2, 0.0119, {}}, {}), 4);  // such a lidar, too, sees the rows beside its lane
  EXPECT_EQ(followed_of({0.01, 0.05, {}}, {}), 4);
  // Narrow ones are not followed through the row beside the lane into the next.
  EXPECT_EQ(followed_of({0.010, 0.003, {}}, {}), 6);
  EXPECT_EQ(followed_of({0.03, 0, {}}, {}), 6);
  EXPECT_EQ(followed_of({0.010, 0.003, {}}, {.farthest_m = 12}), 12);
}

TEST(WideBeamCounters, ABeamThatAPostStopsHasNothingBehindIt) {
  RowSegment s = make_row_segment();
  s.slope_along = s.slope_across = 0;
  const Vector3d base = testing::map_from_grid(s, {4.5, 5, -s.up_min_m / s.voxel_m});
  tile::SegmentBatch rays;
  push_ray(rays, testing::map_from_grid(s, {4.5, -3, 5}), testing::map_from_grid(s, {4.5, 4.6, 5}), true);
  rays.intensity[0] = 500;
  const std::vector<WoodCylinder> post{{1, base, Vector3d::UnitZ(), 0.05, 2}};
  const auto behind = [&](const std::vector<WoodCylinder>& wood) {
    std::int64_t sum = 0;
    const TileVoxels voxels = count_all({s}, rays, wood, view_from(rays.entry[0], {0.01, 0, {}}, 0.2));
    for (const EchoCounters& e : voxels.row_segments[0].echoes) sum += e.behind + e.echo;
    return sum;
  };
  EXPECT_EQ(behind(post), 0);
  EXPECT_GT(behind({}), 0);
}

}  // namespace
}  // namespace rayfield::density
