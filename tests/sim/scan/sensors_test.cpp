#include <cmath>
#include <numbers>

#include "rayfield/core/map_frame.h"
#include "sim/drive/true_trajectory.h"
#include "tests/sim/recorded_drive.h"
#include "tests/sim/without_errors.h"

namespace rayfield::sim {
namespace {

TEST(Sensors, MessagesComeInTheOrderOfTheirStampsAtTheirRates) {
  const RecordedDrive record(small_site_without_lidar());
  const double seconds = record.drive.duration_s();
  EXPECT_NEAR(static_cast<double>(record.imu_samples.size()), 100 * seconds, 1.5);
  EXPECT_NEAR(static_cast<double>(record.angles.size()), 100 * seconds, 1.5);
  EXPECT_NEAR(static_cast<double>(record.fixes.size()), 10 * seconds, 1.5);
  EXPECT_NEAR(static_cast<double>(record.scans.size()), 100 * seconds, 1.5);
  EXPECT_TRUE(record.in_order);
  EXPECT_EQ(record.imu_samples.front().time_s, 1549843200);  // 2019-02-11T00:00:00Z
  EXPECT_EQ(record.summary.imu_samples, record.imu_samples.size());
  EXPECT_EQ(record.summary.lidar_messages, record.scans.size());
}

TEST(Sensors, TheEncoderUnwindsToTheSpinRate) {
  Site site = without_errors(small_site_without_lidar());
  site.spinning.spin_wobble_rad = 0;
  const RecordedDrive record(site);
  double unwound = record.angles.front().angle_rad;
  for (std::size_t i = 1; i < record.angles.size(); ++i) {
    EXPECT_LE(std::abs(record.angles[i].angle_rad), std::numbers::pi);
    unwound += std::remainder(record.angles[i].angle_rad - record.angles[i - 1].angle_rad, 2 * std::numbers::pi);
  }
  const double seconds = record.angles.back().time_s - record.angles.front().time_s;
  EXPECT_NEAR(unwound, 2 * std::numbers::pi * 0.5 * seconds, 1e-5);
}

TEST(Sensors, NoiseFreeImuReadsTheTrajectory) {
  const RecordedDrive record(without_errors(small_site_without_lidar()));
  for (std::size_t i = 0; i < record.imu_samples.size(); i += 37) {
    const ImuSample& sample = record.imu_samples[i];
    const Motion motion = record.drive.trajectory->motion(static_cast<double>(i) / 100);
    EXPECT_EQ(sample.angular_velocity_rad_s, motion.angular_velocity);
    EXPECT_EQ(sample.linear_acceleration_m_s2, motion.specific_force());
  }
}

TEST(Sensors, ImuNoiseHasTheStatedDensity) {
  Site site = without_errors(small_site_without_lidar());
  site.imu.gyro_noise_rad_s_sqrt_hz = 3e-4;
  site.imu.accel_noise_m_s2_sqrt_hz = 3e-3;
  site.dates[0].imu_noise_scale = 3;
  const RecordedDrive record(site);
  double gyro = 0, accel = 0;
  for (std::size_t i = 0; i < record.imu_samples.size(); ++i) {
    const Motion motion = record.drive.trajectory->motion(static_cast<double>(i) / 100);
    gyro += (record.imu_samples[i].angular_velocity_rad_s - motion.angular_velocity).squaredNorm();
    accel += (record.imu_samples[i].linear_acceleration_m_s2 - motion.specific_force()).squaredNorm();
  }
  const double n = 3 * static_cast<double>(record.imu_samples.size());
  const double bound = 5 / std::sqrt(2 * n);  // relative, five standard errors
  EXPECT_NEAR(std::sqrt(gyro / n) / (3 * 3e-4 * 10), 1, bound);
  EXPECT_NEAR(std::sqrt(accel / n) / (3 * 3e-3 * 10), 1, bound);
}

TEST(Sensors, NoiseFreeGpsIsTheAntenna) {
  const Site site = without_errors(small_site_without_lidar());
  const RecordedDrive record(site);
  const TangentPlane plane({site.latitude_deg, site.longitude_deg, site.height_m});
  for (const GpsFix& fix : record.fixes) {
    const Eigen::Vector3d p = plane.enu_from_geodetic({fix.latitude_deg, fix.longitude_deg, fix.height_m});
    const Rigid3 pose = record.drive.trajectory->motion(fix.time_s - record.drive.start_time_s).enu_from_imu;
    EXPECT_NEAR((p - pose * site.mount.imu_from_gps_m).norm(), 0, 1e-4);  // stamps resolve 0.2 µs
  }
}

TEST(Sensors, GpsJumpsAndIsSilentDuringOutages) {
  Site site = without_errors(small_site_without_lidar());
  site.dates[0].gps_outages = {{5, 10}};
  site.dates[0].gps_jumps = {{20, 4, 5, 0, -1}};
  const RecordedDrive record(site);
  const TangentPlane plane({site.latitude_deg, site.longitude_deg, site.height_m});
  int jumped = 0;
  for (const GpsFix& fix : record.fixes) {
    const double t = fix.time_s - record.drive.start_time_s;
    EXPECT_FALSE(t > 5.01 && t < 14.99);
    const Eigen::Vector3d p = plane.enu_from_geodetic({fix.latitude_deg, fix.longitude_deg, fix.height_m});
    const Eigen::Vector3d antenna = record.drive.trajectory->motion(t).enu_from_imu * site.mount.imu_from_gps_m;
    const bool inside = t > 19.99 && t < 23.99;
    EXPECT_NEAR((p - antenna - (inside ? Eigen::Vector3d(5, 0, -1) : Eigen::Vector3d::Zero())).norm(), 0, 1e-4);
    jumped += inside ? 1 : 0;
  }
  EXPECT_EQ(jumped, 40);
}

TEST(Sensors, GpsBiasIsAGaussMarkovProcessOfItsStatedSize) {
  Site site = without_errors(small_site_without_lidar());
  site.gps.bias_horizontal_m = 0.5;
  site.gps.bias_time_constant_s = 2;
  const TangentPlane plane({site.latitude_deg, site.longitude_deg, site.height_m});
  double squares = 0, products = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    site.dates[0].seed = seed;
    const RecordedDrive record(site, {.rays = false});
    Eigen::Vector2d last = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < record.fixes.size(); ++i) {
      const GpsFix& fix = record.fixes[i];
      const Eigen::Vector3d antenna =
          record.drive.trajectory->motion(0.1 * static_cast<double>(i)).enu_from_imu * site.mount.imu_from_gps_m;
      const Eigen::Vector2d bias =
          (plane.enu_from_geodetic({fix.latitude_deg, fix.longitude_deg, fix.height_m}) - antenna).head<2>();
      if (i > 0) squares += last.squaredNorm(), products += last.dot(bias), count += 2;
      last = bias;
    }
  }
  // Samples are worth 2·2 s each: about count / 40 independent ones.
  EXPECT_NEAR(squares / count, 0.25, 0.25 * 5 * std::sqrt(2.0 / (count / 40.0)));
  EXPECT_NEAR(products / squares, std::exp(-0.05), 0.02);
}

TEST(Sensors, TimeErrorsShiftTheStampsAndNotTheData) {
  Site site = without_errors(small_site_without_lidar());
  const RecordedDrive right(site);
  site.dates[0].lidar_time_error_s = 0.02;
  site.dates[0].gps_time_error_s = -0.3;
  const RecordedDrive wrong(site);
  EXPECT_NEAR(right.scans[100].time_s - wrong.scans[100].time_s, 0.02, 1e-6);
  EXPECT_EQ(right.scans[100].range_m, wrong.scans[100].range_m);
  EXPECT_NEAR(right.fixes[10].time_s - wrong.fixes[10].time_s, -0.3, 1e-6);
  EXPECT_EQ(right.fixes[10].latitude_deg, wrong.fixes[10].latitude_deg);
  EXPECT_EQ(right.rays.time_s, wrong.rays.time_s);
  EXPECT_TRUE(wrong.in_order);
}

}  // namespace
}  // namespace rayfield::sim
