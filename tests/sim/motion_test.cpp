#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

Drive small_drive(const Site& site) { return take(plan_drive(make_world(site))); }

struct State {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d velocity, position;
};

// Right-hand side of strapdown navigation with perfect instruments.
struct Rate {
  Eigen::Vector4d rotation;  // x, y, z, w
  Eigen::Vector3d velocity, position;
};

Rate rate_of(const State& s, const Motion& sample) {
  const Eigen::Vector3d& w = sample.angular_velocity;
  const Eigen::Quaterniond q = s.rotation * Eigen::Quaterniond(0, w.x(), w.y(), w.z());
  const Eigen::Vector3d f = sample.specific_force();
  return {0.5 * q.coeffs(), s.rotation.normalized() * f - Eigen::Vector3d(0, 0, kGravity), s.velocity};
}

State moved(const State& s, const Rate& r, double h) {
  State out = s;
  out.rotation.coeffs() += h * r.rotation;
  out.velocity += h * r.velocity, out.position += h * r.position;
  return out;
}

TEST(Trajectory, PerfectImuSamplesIntegrateBackToTheTrajectory) {
  Site site = small_site();
  site.rows.length_m = 26;
  site.dates[0].speed_m_s = 1.5;
  const Drive drive = small_drive(site);
  constexpr double kPeriod = 0.01;  // the IMU's; a Runge–Kutta step takes three samples
  const Motion first = drive.trajectory.motion(0);
  State s{first.enu_from_imu.rotation, first.velocity, first.enu_from_imu.translation};
  double worst_position = 0, worst_angle = 0;
  ASSERT_GT(drive.duration_s(), 60);
  for (int i = 0; i < 3000; ++i) {
    const double t = 2 * i * kPeriod, h = 2 * kPeriod;
    const Motion a = drive.trajectory.motion(t), b = drive.trajectory.motion(t + kPeriod),
                 c = drive.trajectory.motion(t + h);
    const Rate k1 = rate_of(s, a), k2 = rate_of(moved(s, k1, h / 2), b), k3 = rate_of(moved(s, k2, h / 2), b),
               k4 = rate_of(moved(s, k3, h), c);
    for (const auto& [k, weight] : {std::pair(k1, 1.0), {k2, 2.0}, {k3, 2.0}, {k4, 1.0}})
      s = moved(s, k, h * weight / 6);
    s.rotation.normalize();
    worst_position = std::max(worst_position, (s.position - c.enu_from_imu.translation).norm());
    worst_angle = std::max(worst_angle, s.rotation.angularDistance(c.enu_from_imu.rotation));
  }
  EXPECT_LT(worst_position, 1e-4);
  EXPECT_LT(worst_angle, 1e-7);
}

TEST(Trajectory, DerivativesAgreeWithDifferencesOfThePoses) {
  const Drive drive = small_drive(small_site());
  constexpr double kStep = 1e-4;
  for (double t = 0.5; t < drive.duration_s() - 1; t += 0.73) {
    const Motion before = drive.trajectory.motion(t - kStep), now = drive.trajectory.motion(t),
                 after = drive.trajectory.motion(t + kStep);
    const Eigen::Vector3d velocity = (after.enu_from_imu.translation - before.enu_from_imu.translation) / (2 * kStep);
    EXPECT_NEAR((now.velocity - velocity).norm(), 0, 1e-5);
    EXPECT_NEAR((now.acceleration - (after.velocity - before.velocity) / (2 * kStep)).norm(), 0, 1e-4);
    const Eigen::AngleAxisd turn(before.enu_from_imu.rotation.conjugate() * after.enu_from_imu.rotation);
    EXPECT_NEAR((now.angular_velocity - turn.angle() * turn.axis() / (2 * kStep)).norm(), 0, 1e-5);
    const auto matrix = drive.trajectory.pose(t);
    EXPECT_NEAR((matrix.rotation - now.enu_from_imu.rotation.toRotationMatrix()).norm(), 0, 1e-12);
    EXPECT_NEAR((matrix.translation - now.enu_from_imu.translation).norm(), 0, 1e-12);
  }
}

TEST(Trajectory, AccelerationIsContinuousAcrossKnots) {
  const Drive drive = small_drive(small_site());
  for (double knot = 0.5; knot < drive.duration_s() - 0.5; knot += 0.1) {
    const Motion before = drive.trajectory.motion(knot - 1e-7), after = drive.trajectory.motion(knot + 1e-7);
    EXPECT_NEAR((before.acceleration - after.acceleration).norm(), 0, 1e-4);
  }
}

TEST(Drive, StandsStillForTheStationaryStartAndNotWithoutOne) {
  Site site = small_site();
  site.vehicle.vibration_m = 0;
  site.dates[0].stationary_start_s = 10;
  const Drive standing = small_drive(site);
  for (double t = 0; t < 9.5; t += 0.1) {
    EXPECT_LT(standing.trajectory.motion(t).velocity.norm(), 1e-3);
    EXPECT_NEAR(standing.trajectory.motion(t).specific_force().norm(), kGravity, 1e-3);
  }
  site.dates[0].stationary_start_s = 0;
  EXPECT_NEAR(small_drive(site).trajectory.motion(0.5).velocity.norm(), site.dates[0].speed_m_s, 0.25);
}

TEST(Drive, FollowsEveryLaneInTheSkippedOrderAtTheAskedSpeed) {
  Site site = small_site();
  site.rows.count = 4;
  site.dates[0].speed_m_s = 1.2;
  const World world = make_world(site);
  const Drive drive = take(plan_drive(world));
  EXPECT_EQ(drive.lanes, (std::vector<int>{0, 2, 4, 3, 1}));
  std::vector<int> driven;
  double sum = 0;
  int count = 0;
  for (double t = 0; t < drive.duration_s(); t += 0.1) {
    const Motion motion = drive.trajectory.motion(t);
    const auto at = world.block().row_position(0, motion.enu_from_imu.translation.head<2>());
    if (at.chainage < 4 || at.chainage > 9) continue;
    const double lane = at.offset / site.rows.spacing_m + 0.5;
    EXPECT_NEAR(lane, std::round(lane), 0.35 / site.rows.spacing_m);  // five standard deviations of the wander
    if (driven.empty() || driven.back() != std::lround(lane)) driven.push_back(static_cast<int>(std::lround(lane)));
    sum += motion.velocity.head<2>().norm(), ++count;
  }
  EXPECT_EQ(driven, drive.lanes);
  EXPECT_NEAR(sum / count, 1.2, 0.08);
}

TEST(Drive, TakesGivenLanesInTheGivenOrder) {
  Site site = small_site();
  site.dates[0].lanes = {2, 0};
  EXPECT_EQ(small_drive(site).lanes, (std::vector<int>{2, 0}));
  site.dates[0].lanes.clear();
  site.dates[0].order = LaneOrder::reverse;
  EXPECT_EQ(small_drive(site).lanes, (std::vector<int>{2, 1, 0}));
}

TEST(Drive, CarriesTheImuAtItsHeightOverTheGround) {
  Site site = bare_site();
  site.vehicle.bump_m = site.vehicle.vibration_m = 0;
  const Drive drive = small_drive(site);
  for (double t = 0; t < drive.duration_s(); t += 0.5)
    EXPECT_NEAR(drive.trajectory.motion(t).enu_from_imu.translation.z(), site.vehicle.imu_height_m, 0.01);
}

TEST(Drive, TiltsWithTheGround) {
  Site site = bare_site();
  site.terrain.slope_percent = 8;
  site.terrain.slope_azimuth_deg = site.rows.azimuth_deg;  // up the rows
  site.vehicle.bump_m = site.vehicle.vibration_m = 0;
  const World world = make_world(site);
  const Drive drive = take(plan_drive(world));
  const Eigen::Vector3d forward = drive.trajectory.pose(0.5).rotation.col(0);
  EXPECT_NEAR(forward.z(), std::sin(std::atan(0.08)), 2e-3);
}

TEST(Drive, DatesDifferByTheirSeed) {
  Site site = small_site();
  const Drive a = small_drive(site);
  site.dates[0].seed = 99;
  const Drive b = small_drive(site);
  EXPECT_GT((a.trajectory.pose(10).translation - b.trajectory.pose(10).translation).norm(), 0.01);
}

TEST(UniformSpline, ReproducesStraightLines) {
  std::vector<Eigen::Matrix<double, 1, 1>> control;
  for (int i = -2; i < 12; ++i) control.emplace_back(3.0 + 0.5 * i);
  const UniformSpline<1> spline(0, 0.25, control);
  for (double t = 0; t <= spline.end(); t += 0.01) {
    const auto at = spline.evaluate(t);
    EXPECT_NEAR(at.value[0], 3 + 2 * t, 1e-12);
    EXPECT_NEAR(spline.value(t)[0], 3 + 2 * t, 1e-12);
    EXPECT_NEAR(at.first[0], 2, 1e-12);
    EXPECT_NEAR(at.second[0], 0, 1e-10);
  }
}

}  // namespace
}  // namespace rayfield::sim
