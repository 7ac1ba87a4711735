#include "libslam/pipeline/quality_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "libslam/global_registration/registration_problem.h"
#include "libslam/pipeline/run_report.h"
#include "tests/libslam/straight_track.h"

namespace rayfield::slam {
namespace {

using testing::kStep;
using testing::straight_track;

// A straight drive whose IMU has the noise that the rig states.
struct StraightDrive {
  Rig rig;
  SlamOptions options;
  LogSection section;
  GpsTrack gps;
  GpsAlignment alignment;
  GpsOffsetFit offset;
  StraightDrive() {
    OdometryResult& odometry = section.odometry;
    odometry.track = straight_track(60, 1.5);
    odometry.inertial.push_back({30, {}});
    odometry.noise = {rig.imu.gyro_noise_rad_s_sqrt_hz, rig.imu.accel_noise_m_s2_sqrt_hz, 1, 1};
    WindowStats window;
    window.matches = 1000, window.inlier_fraction = 1;
    odometry.windows.assign(10, window);
    section.imu.emplace(0.0, kStep);
    std::mt19937_64 random(7);
    std::normal_distribution<double> unit(0, 1);
    const auto white = [&](double density) {
      return Eigen::Vector3d(density / std::sqrt(kStep) * Eigen::Vector3d(unit(random), unit(random), unit(random)));
    };
    for (int k = 0; k < odometry.track.size(); ++k)
      section.imu->add({k * kStep, white(odometry.noise.gyro_density),
                        Eigen::Vector3d(0, 0, 9.80665) + white(odometry.noise.accel_density)});
  }
  RegistrationStats misfit() {
    const RegistrationUnknowns unknowns;
    RegistrationProblem problem(section.odometry, *section.imu, {}, rig, options, 1.0, unknowns);
    RegistrationStats stats;
    problem.begin({}), problem.end(stats);
    problem.measure_imu_misfit(stats);
    return stats;
  }
  Result<void> check(const RegistrationStats& stats, SlamReport& report) {
    const RunFacts facts{section, gps, alignment, stats, rig, options, offset, Eigen::Quaterniond::Identity()};
    SlamResult result;
    report = make_report(facts, result);
    return check_quality(facts, report);
  }
};

bool warns(const SlamReport& report, const char* of) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [of](const std::string& w) { return w.find(of) != std::string::npos; });
}

TEST(ImuMisfit, IsAboutOneOnARightPath) {
  StraightDrive d;
  const RegistrationStats stats = d.misfit();
  EXPECT_GT(stats.imu_misfit, 0.8);
  EXPECT_LT(stats.imu_misfit, 2.0);
  SlamReport report;
  EXPECT_TRUE(d.check(stats, report));
  EXPECT_FALSE(warns(report, "IMU"));
}

TEST(ImuMisfit, TellsThatALaneMovedByARowWithinSomeTenMetres) {
  StraightDrive d;
  // y = 2.4 m · (10 u³ − 15 u⁴ + 6 u⁵) from 20 to 35 s.
  constexpr double kShift = 2.4, kBegin = 20, kLength = 15;
  const auto velocity = [](double t) {
    const double u = std::clamp((t - kBegin) / kLength, 0.0, 1.0);
    return kShift / kLength * 30 * u * u * (1 - u) * (1 - u);
  };
  double y = 0, largest = 0;
  for (int k = 0; k < d.section.odometry.track.size(); ++k) {
    y += kStep * velocity((k + 0.5) * kStep);
    d.section.odometry.track.position[static_cast<std::size_t>(k)].y() = y;
  }
  for (double t = 0; t < 55; t += 2.5) largest = std::max(largest, std::abs(velocity(t + 5) - velocity(t)) / 5);
  // Mean acceleration over five seconds against its noise, one of six components.
  const double expected = largest / (d.section.odometry.noise.accel_density / std::sqrt(5.0)) / std::sqrt(6.0);
  const RegistrationStats stats = d.misfit();
  EXPECT_NEAR(stats.imu_misfit, expected, 0.1 * expected);
  SlamReport report;
  const Result<void> checked = d.check(stats, report);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::bad_input);
  EXPECT_NE(checked.error().line().find("contradicts the IMU"), std::string::npos) << checked.error().line();
}

TEST(CheckQuality, WarnsOfSectionsThatStandOutAndRefusesATornMap) {
  StraightDrive d;
  RegistrationStats stats = d.misfit();
  SlamReport report;
  stats.revisits = {0.009, 50, 0.006};
  EXPECT_TRUE(d.check(stats, report));
  EXPECT_FALSE(warns(report, "torn"));
  stats.revisits = {0.025, 50, 0.006};
  EXPECT_TRUE(d.check(stats, report));
  EXPECT_TRUE(warns(report, "torn"));
  EXPECT_EQ(report.visit_offset_worst_m, 0.025);
  stats.revisits = {0.07, 470, 0.007};
  const Result<void> torn = d.check(stats, report);
  ASSERT_FALSE(torn);
  EXPECT_NE(torn.error().line().find("470 s"), std::string::npos) << torn.error().line();
}

TEST(CheckQuality, RefusesADriveWithAWindowThatContradictsItself) {
  StraightDrive d;
  const RegistrationStats stats = d.misfit();
  SlamReport report;
  d.section.odometry.windows[6].start_s = 30, d.section.odometry.windows[6].end_s = 35;
  d.section.odometry.windows[6].inlier_fraction = 0.93;
  EXPECT_TRUE(d.check(stats, report));
  EXPECT_FALSE(warns(report, "disturbed"));
  EXPECT_EQ(report.window_inliers_least, 0.93);
  d.section.odometry.windows[6].inlier_fraction = 0.85;
  EXPECT_TRUE(d.check(stats, report));
  EXPECT_TRUE(warns(report, "disturbed"));
  d.section.odometry.windows[6].inlier_fraction = 0.6;
  const Result<void> checked = d.check(stats, report);
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().line().find("around 32 s"), std::string::npos) << checked.error().line();
}

}  // namespace
}  // namespace rayfield::slam
