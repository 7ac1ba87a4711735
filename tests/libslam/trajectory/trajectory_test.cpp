#include "rayfield/slam/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "libslam/trajectory/so3.h"

namespace rayfield::slam {
namespace {

TEST(MakeTrajectory, RefusesTimesThatDoNotIncreaseAndValuesThatAreNotFinite) {
  std::vector<TimedPose> poses(3);
  poses[0].time_s = 1, poses[1].time_s = 2, poses[2].time_s = 2;
  EXPECT_FALSE(make_trajectory(poses, ""));
  poses[2].time_s = 3;
  EXPECT_TRUE(make_trajectory(poses, ""));
  poses[1].map_from_body.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(make_trajectory(poses, ""));
}

TEST(Trajectory, InterpolatesWhateverTheOrderOfQueries) {
  Trajectory t;
  for (int k = 0; k < 100; ++k) t.poses.push_back({0.1 * k, {exp_so3({0, 0, 0.05 * k}), {1.0 * k, 0, 0}}});
  std::size_t cursor = 0;
  Rigid3 pose;
  for (const double time : {0.0, 5.03, 5.04, 1.27, 9.9, 9.87, 0.01}) {
    ASSERT_TRUE(t.at(time, pose, cursor)) << time;
    EXPECT_NEAR(pose.translation.x(), 10 * time, 1e-9);
    EXPECT_NEAR(log_so3(pose.rotation).z(), 0.5 * time - (0.5 * time > M_PI ? 2 * M_PI : 0), 1e-9);
  }
  EXPECT_FALSE(t.at(-0.01, pose, cursor));
  EXPECT_FALSE(t.at(9.91, pose, cursor));
  EXPECT_FALSE(t.at(std::numeric_limits<double>::quiet_NaN(), pose, cursor));
}

}  // namespace
}  // namespace rayfield::slam
