#include "sim/drive/true_trajectory.h"

#include <Eigen/Geometry>

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

TEST(TrueTrajectory, PerfectImuSamplesIntegrateBackToTheTrajectory) {
  Site site = small_site();
  site.rows.length_m = 26;
  site.dates[0].speed_m_s = 1.5;
  const Drive drive = small_drive(site);
  constexpr double kPeriod = 0.01;  // the IMU's; a Runge–Kutta step takes three samples
  const Motion first = drive.trajectory->motion(0);
  State s{first.enu_from_imu.rotation, first.velocity, first.enu_from_imu.translation};
  double worst_position = 0, worst_angle = 0;
  ASSERT_GT(drive.duration_s(), 60);
  for (int i = 0; i < 3000; ++i) {
    const double t = 2 * i * kPeriod, h = 2 * kPeriod;
    const Motion a = drive.trajectory->motion(t), b = drive.trajectory->motion(t + kPeriod),
                 c = drive.trajectory->motion(t + h);
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

TEST(TrueTrajectory, DerivativesAgreeWithDifferencesOfThePoses) {
  const Drive drive = small_drive(small_site());
  constexpr double kStep = 1e-4;
  for (double t = 0.5; t < drive.duration_s() - 1; t += 0.73) {
    const Motion before = drive.trajectory->motion(t - kStep), now = drive.trajectory->motion(t),
                 after = drive.trajectory->motion(t + kStep);
    const Eigen::Vector3d velocity = (after.enu_from_imu.translation - before.enu_from_imu.translation) / (2 * kStep);
    EXPECT_NEAR((now.velocity - velocity).norm(), 0, 1e-5);
    EXPECT_NEAR((now.acceleration - (after.velocity - before.velocity) / (2 * kStep)).norm(), 0, 1e-4);
    const Eigen::AngleAxisd turn(before.enu_from_imu.rotation.conjugate() * after.enu_from_imu.rotation);
    EXPECT_NEAR((now.angular_velocity - turn.angle() * turn.axis() / (2 * kStep)).norm(), 0, 1e-5);
    const auto matrix = drive.trajectory->pose(t);
    EXPECT_NEAR((matrix.rotation - now.enu_from_imu.rotation.toRotationMatrix()).norm(), 0, 1e-12);
    EXPECT_NEAR((matrix.translation - now.enu_from_imu.translation).norm(), 0, 1e-12);
  }
}

TEST(TrueTrajectory, AccelerationIsContinuousAcrossKnots) {
  const Drive drive = small_drive(small_site());
  for (double knot = 0.5; knot < drive.duration_s() - 0.5; knot += 0.1) {
    const Motion before = drive.trajectory->motion(knot - 1e-7), after = drive.trajectory->motion(knot + 1e-7);
    EXPECT_NEAR((before.acceleration - after.acceleration).norm(), 0, 1e-4);
  }
}

}  // namespace
}  // namespace rayfield::sim
