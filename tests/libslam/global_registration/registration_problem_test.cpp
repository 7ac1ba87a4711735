#include "libslam/global_registration/registration_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "tests/libslam/pole_row.h"

namespace rayfield::slam {
namespace {

using testing::drive_along;
using testing::Row;

// An exact IMU and no surfels; one step.
TEST(RegistrationProblem, PutsALaneRightByItsPoles) {
  constexpr double kOff = 0.03;
  const Row row = drive_along(std::vector<double>(24, 0.0275), kOff);
  const Row right = drive_along(std::vector<double>(24, 0.0275), 0);
  OdometryResult odometry;
  odometry.track = row.track, odometry.poles = row.detections;
  odometry.inertial.push_back({10, {}});
  odometry.noise = {3e-4, 0.01, 1, 1};
  ImuGrid imu(0, odometry.track.step_s);
  const double dt = odometry.track.step_s;
  for (int k = 0; k < right.track.size(); ++k) {
    const int n = std::clamp(k, 1, right.track.size() - 2);
    const auto& p = right.track.position;
    const Eigen::Quaterniond &r0 = right.track.rotation[n - 1], &r1 = right.track.rotation[n + 1];
    const Eigen::Vector3d force = (p[n + 1] - 2 * p[n] + p[n - 1]) / (dt * dt) + Eigen::Vector3d(0, 0, 9.80665);
    imu.add({k * dt, log_so3(r0.conjugate() * r1) / (2 * dt), right.track.rotation[n].conjugate() * force});
  }
  const Rig rig;
  const SlamOptions options;
  RegistrationProblem problem(odometry, imu, {}, rig, options, 1.0, {.pole_depth_m = options.poles.depth_m});
  RegistrationStats stats;
  problem.begin({});
  problem.add_poles({.reach_m = 0.15});
  problem.end(stats);
  EXPECT_EQ(stats.poles.count, 24u);
  ASSERT_TRUE(problem.solve_and_apply());
  const auto across = [&](double time_s) { return odometry.track.pose(time_s).translation.y(); };
  const double apart = across(odometry.track.end_s() - 20) - across(20);
  // What is left and the depth go together: lanes and trunks alone do not tell a thicker trunk from a wider alley.
  const double deeper = problem.unknowns().pole_depth_m - std::numbers::pi / 4 * 0.0275;
  EXPECT_NEAR(apart, 2.8 + 2 * 0.85 * deeper, 0.006);
}

}  // namespace
}  // namespace rayfield::slam
