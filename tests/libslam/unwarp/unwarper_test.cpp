#include "libslam/unwarp/unwarper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/libslam/synthetic_scene.h"

namespace rayfield::slam {
namespace {

using testing::SceneOptions;
using testing::short_scene;
using testing::true_trajectory;

TEST(Unwarper, PutsEveryHitOfATrueTrajectoryOntoTheSurfaceItCameFrom) {
  const SceneOptions scene = short_scene(6, 1);
  const Rig rig = testing::scene_rig();
  const Trajectory truth = true_trajectory(1, 6);
  std::size_t hits = 0;
  Unwarper unwarper(rig, truth, {}, [&](const RayBatch& rays) -> Result<void> {
    for (std::size_t k = 0; k < rays.size(); ++k) {
      if (rays.hit[k] == 0) continue;
      ++hits;
      const Eigen::Vector3d d = rays.end[k] - rays.origin[k];
      // Interpolating poses and the encoder at 100 Hz costs well under a millimetre at this motion; a grazing edge may
      // be missed or hit by that much, so a point is right if a surface lies within a few millimetres of it.
      const double range = testing::scene_range(rays.origin[k], d.normalized());
      const double beyond = testing::scene_range(rays.end[k] - 0.005 * d.normalized(), d.normalized());
      EXPECT_TRUE(std::abs(range - d.norm()) < 0.004 || beyond < 0.012) << k;
    }
    return {};
  });
  testing::feed_scene(unwarper, rig, scene);
  ASSERT_TRUE(unwarper.finish());
  EXPECT_GT(hits, 50000u);
  EXPECT_EQ(unwarper.counts().hits, hits);
}

// One upward, one downward beam and one of each bad kind, straight from the IMU's origin.
struct Fixture {
  Rig rig;
  Trajectory level;
  LidarScan scan;
  Fixture() {
    rig.lidar.min_range_m = 0.5, rig.lidar.max_range_m = 40;
    for (int k = 0; k < 3; ++k)
      level.poses.push_back({100.0 + 0.1 * k, {Eigen::Quaterniond::Identity(), {500, 600, 7}}});
    scan.time_s = 100.05;
    const Eigen::Vector3f up = Eigen::Vector3f(0.6f, 0, 0.8f), down(0.6f, 0, -0.8f);
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    for (const auto& [d, r] :
         {std::pair(up, 10.0f), std::pair(up, inf), std::pair(down, inf), std::pair(down, nan), std::pair(up, -inf),
          std::pair(up, 0.3f), std::pair(up, 45.0f), std::pair(down, 45.0f)}) {
      scan.direction.push_back(d), scan.range_m.push_back(r);
      scan.time_offset_s.push_back(0.0f), scan.intensity.push_back(321.4f);
    }
  }
};

TEST(Unwarper, KeepsUpwardRaysWithoutReturnAtFullLength) {
  const Fixture f;
  RayBatch rays;
  Unwarper unwarper(f.rig, f.level, {}, [&](const RayBatch& b) -> Result<void> {
    rays = b;
    return {};
  });
  unwarper.lidar(f.scan);
  ASSERT_TRUE(unwarper.finish());
  ASSERT_EQ(rays.size(), 3u);  // the hit, the upward +inf and the upward one beyond max_range_m
  EXPECT_EQ(rays.hit[0], 1);
  EXPECT_LT((rays.end[0] - Eigen::Vector3d(506, 600, 15)).norm(), 1e-5);
  EXPECT_EQ(rays.intensity[0], 321);
  for (int k : {1, 2}) {
    EXPECT_EQ(rays.hit[k], 0);
    EXPECT_EQ(rays.intensity[k], 0);
    EXPECT_LT((rays.end[k] - Eigen::Vector3d(524, 600, 39)).norm(), 1e-4);
  }
  EXPECT_EQ(unwarper.counts().stopped_by_vehicle, 2u);  // nothing has come back from down there yet
  EXPECT_EQ(unwarper.counts().invalid, 3u);
}

TEST(Unwarper, OfSeveralBeamsKeepsDownwardRaysWhereSomethingReturnsNowAndThen) {
  Fixture f;
  const Eigen::Vector3f open(0.6f, 0, -0.8f), bonnet(0.8f, 0, -0.6f);
  const float inf = std::numeric_limits<float>::infinity();
  const auto beam = [&](const Eigen::Vector3f& direction, float range) {
    f.scan.direction.push_back(direction), f.scan.range_m.push_back(range);
    f.scan.time_offset_s.push_back(0.0f), f.scan.intensity.push_back(100.0f);
  };
  f.scan.direction.clear(), f.scan.range_m.clear(), f.scan.time_offset_s.clear(), f.scan.intensity.clear();
  for (int k = 0; k < 40; ++k) beam(open, k % 4 == 0 ? 5.0f : inf), beam(bonnet, inf);
  std::size_t misses = 0;
  Unwarper unwarper(f.rig, f.level, {}, [&](const RayBatch& rays) -> Result<void> {
    for (std::size_t k = 0; k < rays.size(); ++k) {
      if (rays.hit[k] != 0) continue;
      ++misses;
      EXPECT_LT((rays.end[k] - Eigen::Vector3d(524, 600, -25)).norm(), 1e-4);  // at full length, below the ground
    }
    return {};
  });
  unwarper.lidar(f.scan);
  ASSERT_TRUE(unwarper.finish());
  EXPECT_EQ(misses, 16u);  // of the 20th beam and later
  EXPECT_EQ(unwarper.counts().downward_kept, misses);
  EXPECT_EQ(unwarper.counts().stopped_by_vehicle, 14u + 40u);
}

// The same fan of beams in the plane that the lidar turns in: adding the cloud restores what is missing.
TEST(Unwarper, OfOneBeamInAPlaneDropsDownwardRaysWithoutReturn) {
  Fixture f;
  const Eigen::Quaterniond on_its_side(Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitX()));
  for (auto& pose : f.level.poses) pose.map_from_body.rotation = on_its_side;
  for (Eigen::Vector3f& d : f.scan.direction) d = Eigen::Vector3f(d.x(), d.z(), 0);
  const LidarScan scan = f.scan;
  Unwarper unwarper(f.rig, f.level, {}, [](const RayBatch&) -> Result<void> { return {}; });
  for (int k = 0; k < 30; ++k) unwarper.lidar(scan);
  ASSERT_TRUE(unwarper.finish());
  EXPECT_EQ(unwarper.counts().rays, unwarper.counts().hits * 3);  // two upward without a return for each hit
  EXPECT_EQ(unwarper.counts().downward_no_return, 2 * unwarper.counts().hits);
  EXPECT_EQ(unwarper.counts().downward_kept + unwarper.counts().stopped_by_vehicle, 0u);
}

TEST(Unwarper, StretchesGroundLengthsByTheMapScaleAndLeavesHeightsAlone) {
  Fixture f;
  f.level.horizontal_scale = 1.0004;
  RayBatch rays;
  Unwarper unwarper(f.rig, f.level, {}, [&](const RayBatch& b) -> Result<void> {
    rays = b;
    return {};
  });
  unwarper.lidar(f.scan);
  ASSERT_TRUE(unwarper.finish());
  EXPECT_NEAR(rays.end[0].x(), 500 + 6 * 1.0004, 1e-6);
  EXPECT_NEAR(rays.end[0].z(), 15, 1e-5);
}

TEST(Unwarper, LeavesOutPointsBeyondTheTrajectoryAndInItsGaps) {
  Fixture f;
  f.level.poses.push_back({110, f.level.poses.back().map_from_body});
  Unwarper unwarper(f.rig, f.level, {}, [](const RayBatch&) -> Result<void> { return {}; });
  for (const double time : {99.0, 105.0, 111.0}) {
    f.scan.time_s = time;
    unwarper.lidar(f.scan);
  }
  ASSERT_TRUE(unwarper.finish());
  EXPECT_EQ(unwarper.counts().rays, 0u);
  EXPECT_EQ(unwarper.counts().outside_trajectory, 3u * 5u);
}

TEST(Unwarper, ReturnsTheErrorOfItsTaker) {
  const Fixture f;
  Unwarper unwarper(f.rig, f.level, {}, [](const RayBatch&) -> Result<void> {
    return fail(ErrorCode::resources, "cannot write", "rays", "disk full");
  });
  unwarper.lidar(f.scan);
  const auto done = unwarper.finish();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::resources);
}

}  // namespace
}  // namespace rayfield::slam
