#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "libdensity/voxels/voxel_accumulator.h"
#include "tests/libdensity/voxel_worlds.h"

/// Beams that go down through a row, or beside it (EchoStatistics::silent()).
namespace rayfield::density {
namespace {

using Eigen::Vector3d;
using testing::kBigTile;
using testing::kBigTileSize;
using testing::push_ray;

const Vector3d kSensor(250, 498, 31.6);
constexpr double kGround = 30;

/// A row along x at y = 500, 0.5 m thick, from 0.7 to 1.4 m above level ground.
RowSegment level_row() {
  RowSegment s;
  s.row = 1;
  s.direction = {1, 0}, s.origin = {245, 500};
  s.ground_m = kGround, s.up_min_m = 0.7, s.across_min_m = -0.25, s.voxel_m = 0.1;
  s.n_along = 100, s.n_across = 5, s.n_up = 7;
  return s;
}

/// From the sensor through (x, y) at a height above the ground, so far that it ends at the height of `end_height`.
void push_beam(tile::SegmentBatch& rays, double x, double y, double height, double end_height, bool hit) {
  const Vector3d way = Vector3d(x, y, kGround + height) - kSensor;
  const double share = (kGround + end_height - kSensor.z()) / way.z();
  push_ray(rays, kSensor, kSensor + share * way, hit);
  rays.intensity.back() = hit ? 100 : 0;
}

SilentBeams silent_of(const tile::SegmentBatch& rays, double sure_return_m) {
  VoxelOptions options;
  options.sure_return_m = sure_return_m;
  auto view = std::make_shared<const BeamView>(BeamView{{0.01, 0.003, {}}, 0.12, SensorTrack({{0, kSensor}})});
  auto accumulator =
      VoxelAccumulator::create({kBigTile, kBigTileSize}, std::vector{level_row()}, {}, options, std::move(view));
  EXPECT_TRUE(accumulator.has_value());
  accumulator->add_pairs(rays);
  return accumulator->echo_statistics()->silent();
}

TEST(DownwardBeams, OfThoseThroughARowItCountsWhichComeBackFromNowhere) {
  tile::SegmentBatch rays;
  for (int i = 0; i < 600; ++i) {
    const double x = 249.7 + 0.001 * i;
    push_beam(rays, x, 500, 1.0, 1.0, true);               // from the row
    push_beam(rays, x, 500, 1.0, 0, true);                 // from the ground behind
    push_beam(rays, x, 500, 1.0, 0, true);                 // again
    if (i < 300) push_beam(rays, x, 500, 1.0, -5, false);  // from nowhere
    push_beam(rays, x, 496, 1.0, 0, true);                 // open ground on the other side
    push_beam(rays, x, 500, 0.3, 0, true);                 // below the row
    push_beam(rays, x, 500, 1.0, 0.1, false);              // cut off above the ground: nothing is known
    push_beam(rays, x, 500, 1.7, 3, false);                // upwards
  }
  const auto used_up = silent_of(rays, 0).used_up(40);  // open ground has 100
  ASSERT_TRUE(used_up);
  EXPECT_NEAR(*used_up, 300.0 / 2100 * (1 - 0.75 * 0.4), 1e-9);
}

TEST(DownwardBeams, AreNotCountedWhereThoseFromNowhereAreMissing) {
  tile::SegmentBatch rays;
  for (int i = 0; i < 3000; ++i) {
    push_beam(rays, 248 + 0.001 * i, 500, 1.0, 0, true);
    push_beam(rays, 248 + 0.001 * i, 496, 1.0, 0, true);
  }
  EXPECT_EQ(silent_of(rays, 0).used_up(40), 0);
  EXPECT_FALSE(silent_of(rays, 30).used_up(40));
}

}  // namespace
}  // namespace rayfield::density
