// What tells a map that is torn from one that is right.
#include "libslam/pipeline/judge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "libslam/global/global_terms.h"
#include "libslam/global/visits.h"

namespace rayfield::slam {
namespace {

constexpr double kStep = 0.01;

PoseTrack straight_track(double duration_s, double speed_m_s) {
  PoseTrack track;
  for (int k = 0; k * kStep <= duration_s; ++k) {
    track.position.push_back(Eigen::Vector3d(speed_m_s * kStep * k, 0, 0));
    track.rotation.push_back(Eigen::Quaterniond::Identity());
  }
  return track;
}

// Level ground in a world frame: the track must not turn.
Surfel ground(const PoseTrack& track, double time_s, double x, double y, double z) {
  Surfel s;
  s.time_s = time_s;
  s.center = (Eigen::Vector3d(x, y, z) - track.pose(time_s).translation).cast<float>();
  s.normal = Eigen::Vector3f::UnitZ();
  return s;
}

// A surface every 0.1 s that is met again 100 s later, `off(t)` higher.
template <class Off>
VisitMisfit misfit_of_visits(const PoseTrack& track, const Off& off) {
  std::vector<Surfel> surfels;
  std::vector<SurfelMatch> revisits;
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.1 * k;
    surfels.push_back(ground(track, t, 0.15 * k, 2, 0));
    surfels.push_back(ground(track, t + 100, 0.15 * k, 2, off(t)));
    revisits.push_back({static_cast<std::uint32_t>(2 * k), static_cast<std::uint32_t>(2 * k + 1)});
  }
  VisitSurvey survey(track.end_s());
  survey.add(track, surfels, revisits);
  return survey.misfit();
}

TEST(VisitMisfit, IsTheSpreadOfTheSurfacesWhereAllVisitsAgree) {
  const PoseTrack track = straight_track(200, 1.5);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 0.004);
  const VisitMisfit m = misfit_of_visits(track, [&](double) { return noise(random); });
  EXPECT_NEAR(m.typical_m, 1.645 * 0.004, 0.001);
  EXPECT_LT(m.worst_m, 1.4 * m.typical_m);
}

TEST(VisitMisfit, StandsOutWhereALaneLiesOnOtherGround) {
  const PoseTrack track = straight_track(200, 1.5);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 0.004), other(0, 0.05);
  const VisitMisfit m =
      misfit_of_visits(track, [&](double t) { return t > 40 && t < 60 ? other(random) : noise(random); });
  EXPECT_NEAR(m.worst_m, 1.645 * 0.05, 0.015);
  EXPECT_TRUE(m.worst_s == 50 || m.worst_s == 150) << m.worst_s;  // either visit
  EXPECT_NEAR(m.typical_m, 1.645 * 0.004, 0.0015);
}

TEST(VisitMisfit, SaysNothingOfADriveWithHardlyAnyRevisit) {
  const PoseTrack track = straight_track(200, 1.5);
  const std::vector<Surfel> surfels = {ground(track, 10, 0, 0, 0), ground(track, 120, 0, 0, 1)};
  VisitSurvey survey(track.end_s());
  EXPECT_EQ(survey.misfit().typical_m, 0);
  EXPECT_EQ(survey.thickness_m(), 0);
  survey.add(track, surfels, std::vector<SurfelMatch>{{0, 1}});
  EXPECT_EQ(survey.misfit().typical_m, 0);
}

TEST(OffsetHistogram, HasTheQuantilesOfWhatItWasGiven) {
  std::mt19937_64 random(7);
  std::exponential_distribution<double> offset(1 / 0.004);
  OffsetHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0);
  for (int k = 0; k < 200000; ++k) histogram.add(offset(random));
  EXPECT_EQ(histogram.count(), 200000u);
  for (const double share : {0.1, 0.5, 0.9, 0.99})
    EXPECT_NEAR(histogram.quantile(share) / (-0.004 * std::log(1 - share)), 1, 0.02) << share;
  OffsetHistogram extremes;
  extremes.add(0), extremes.add(0), extremes.add(1e6);
  EXPECT_LT(extremes.quantile(0.5), 2e-6);
  EXPECT_NEAR(extremes.quantile(1), 2.5, 0.1);
}

// A drive straight on with an IMU of the noise that the rig states, and what the path says against it.
struct StraightDrive {
  Rig rig;
  SlamOptions options;
  Drive drive;
  GpsTrack gps;
  GpsAlignment alignment;
  GpsOffsetFit offset;
  StraightDrive() {
    OdometryResult& odometry = drive.odometry;
    odometry.track = straight_track(60, 1.5);
    odometry.inertial.push_back({30, {}});
    odometry.noise = {rig.imu.gyro_noise_rad_s_sqrt_hz, rig.imu.accel_noise_m_s2_sqrt_hz, 1, 1};
    WindowStats window;
    window.matches = 1000, window.inlier_fraction = 1;
    odometry.windows.assign(10, window);
    drive.imu.emplace(0.0, kStep);
    std::mt19937_64 random(7);
    std::normal_distribution<double> unit(0, 1);
    const auto white = [&](double density) {
      return Eigen::Vector3d(density / std::sqrt(kStep) * Eigen::Vector3d(unit(random), unit(random), unit(random)));
    };
    for (int k = 0; k < odometry.track.size(); ++k)
      drive.imu->add({k * kStep, white(odometry.noise.gyro_density),
                      Eigen::Vector3d(0, 0, 9.80665) + white(odometry.noise.accel_density)});
  }
  GlobalStats misfit() {
    const GlobalUnknowns unknowns;
    GlobalProblem problem(drive.odometry, *drive.imu, {}, rig, options, 1.0, unknowns);
    GlobalStats stats;
    problem.begin({}), problem.end(stats);
    problem.measure_imu_misfit(stats);
    return stats;
  }
  Result<void> verdict(const GlobalStats& stats, SlamReport& report) {
    const RunFacts facts{drive, gps, alignment, stats, rig, options, offset, Eigen::Quaterniond::Identity()};
    SlamResult result;
    report = make_report(facts, result);
    return judge(facts, report);
  }
};

bool warns(const SlamReport& report, const char* of) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [of](const std::string& w) { return w.find(of) != std::string::npos; });
}

TEST(ImuMisfit, IsAboutOneOnARightPath) {
  StraightDrive d;
  const GlobalStats stats = d.misfit();
  EXPECT_GT(stats.imu_misfit, 0.8);
  EXPECT_LT(stats.imu_misfit, 2.0);
  SlamReport report;
  EXPECT_TRUE(d.verdict(stats, report));
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
  for (int k = 0; k < d.drive.odometry.track.size(); ++k) {
    y += kStep * velocity((k + 0.5) * kStep);
    d.drive.odometry.track.position[static_cast<std::size_t>(k)].y() = y;
  }
  for (double t = 0; t < 55; t += 2.5) largest = std::max(largest, std::abs(velocity(t + 5) - velocity(t)) / 5);
  // Mean acceleration over five seconds against its noise, one of six components.
  const double expected = largest / (d.drive.odometry.noise.accel_density / std::sqrt(5.0)) / std::sqrt(6.0);
  const GlobalStats stats = d.misfit();
  EXPECT_NEAR(stats.imu_misfit, expected, 0.1 * expected);
  SlamReport report;
  const Result<void> verdict = d.verdict(stats, report);
  ASSERT_FALSE(verdict);
  EXPECT_EQ(verdict.error().code, ErrorCode::bad_input);
  EXPECT_NE(verdict.error().line().find("contradicts the IMU"), std::string::npos) << verdict.error().line();
}

TEST(Judge, WarnsOfStretchesThatStandOutAndRefusesATornMap) {
  StraightDrive d;
  GlobalStats stats = d.misfit();
  SlamReport report;
  stats.visits = {0.009, 50, 0.006};
  EXPECT_TRUE(d.verdict(stats, report));
  EXPECT_FALSE(warns(report, "torn"));
  stats.visits = {0.025, 50, 0.006};
  EXPECT_TRUE(d.verdict(stats, report));
  EXPECT_TRUE(warns(report, "torn"));
  EXPECT_EQ(report.visit_offset_worst_m, 0.025);
  stats.visits = {0.07, 470, 0.007};
  const Result<void> torn = d.verdict(stats, report);
  ASSERT_FALSE(torn);
  EXPECT_NE(torn.error().line().find("470 s"), std::string::npos) << torn.error().line();
}

TEST(Judge, RefusesADriveWithAWindowThatContradictsItself) {
  StraightDrive d;
  const GlobalStats stats = d.misfit();
  SlamReport report;
  d.drive.odometry.windows[6].start_s = 30, d.drive.odometry.windows[6].end_s = 35;
  d.drive.odometry.windows[6].inlier_fraction = 0.93;
  EXPECT_TRUE(d.verdict(stats, report));
  EXPECT_FALSE(warns(report, "disturbed"));
  EXPECT_EQ(report.window_inliers_least, 0.93);
  d.drive.odometry.windows[6].inlier_fraction = 0.85;
  EXPECT_TRUE(d.verdict(stats, report));
  EXPECT_TRUE(warns(report, "disturbed"));
  d.drive.odometry.windows[6].inlier_fraction = 0.6;
  const Result<void> verdict = d.verdict(stats, report);
  ASSERT_FALSE(verdict);
  EXPECT_NE(verdict.error().line().find("around 32 s"), std::string::npos) << verdict.error().line();
}

}  // namespace
}  // namespace rayfield::slam
