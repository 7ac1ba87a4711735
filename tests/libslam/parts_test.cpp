#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "libslam/gps/georeference.h"
#include "libslam/gps/gps_alignment.h"
#include "libslam/input/imu_grid.h"
#include "libslam/odometry/start.h"
#include "libslam/trajectory/correction_spline.h"
#include "rayfield/slam/slam.h"

namespace rayfield::slam {
namespace {

TEST(CorrectionSpline, ReproducesAQuadratic) {
  // Cubic B-splines contain quadratics: knots c_j of t² are ((j−1)h)² − h²/3.
  const CorrectionSpline spline{2.0, 0.25, 8};
  for (double t = 2.0; t <= 4.0; t += 0.031) {
    const SplineWeights w = spline.weights(t);
    double value = 0, sum = 0;
    for (int j = 0; j < 4; ++j) {
      const double knot = (w.first + j - 1) * 0.25;
      const double c = knot * knot - 0.25 * 0.25 / 3;
      value += w.value[j] * c, sum += w.value[j];
    }
    EXPECT_NEAR(value, (t - 2) * (t - 2), 1e-12);
    EXPECT_NEAR(sum, 1, 1e-14);
  }
}

TEST(So3, ExpAndLogAreInverseUpToHalfATurn) {
  std::mt19937 generator(1);
  std::normal_distribution<double> gauss(0, 1);
  for (int k = 0; k < 1000; ++k) {
    Eigen::Vector3d phi(gauss(generator), gauss(generator), gauss(generator));
    phi *= std::pow(10.0, -k % 12) * 3.1 / std::max(3.1, phi.norm());
    EXPECT_LT((log_so3(exp_so3(phi)) - phi).norm(), 1e-12 + 1e-10 * phi.norm());
  }
}

ImuSample linear_sample(double t) {
  ImuSample s;
  s.time_s = 50 + t;
  s.angular_velocity_rad_s = Eigen::Vector3d(t, 2 * t, -t);
  s.linear_acceleration_m_s2 = Eigen::Vector3d(1 - t, 0, 9.8);
  return s;
}

TEST(ImuGrid, InterpolatesSlowSensorsAndAveragesFastOnes) {
  for (const double rate : {40.0, 100.0, 130.0, 1000.0}) {
    ImuGrid grid(50, 0.01);
    for (int k = 0; k <= static_cast<int>(2 * rate); ++k) grid.add(linear_sample(k / rate));
    ASSERT_GT(grid.size(), 190) << rate;
    // A linear signal: interpolation is exact; the mean over a cell is off by at most half a sample; and a sample that
    // stands alone in its cell off the grid time by at most half a cell.
    for (int k = 1; k < grid.size(); ++k) EXPECT_NEAR(grid.gyro()[k].x(), 0.01 * k, 0.0051) << rate;
    if (rate == 100.0) {
      EXPECT_NEAR(grid.gyro()[77].y(), 1.54, 1e-9);
    }
  }
}

TEST(WhiteNoise, IsMeasuredThroughTheBounceOfTheVehicle) {
  std::mt19937 generator(9);
  std::normal_distribution<double> gauss(0, 1);
  ImuGrid grid(0, 0.01);
  for (int k = 0; k < 1000; ++k) {
    ImuSample s;
    s.time_s = 0.01 * k;
    for (int axis = 0; axis < 3; ++axis) {
      s.angular_velocity_rad_s[axis] = 0.1 * std::sin(6.3 * 3 * s.time_s) + 0.003 * gauss(generator);
      s.linear_acceleration_m_s2[axis] = 2.7 * std::sin(6.3 * 3.1 * s.time_s) + 0.09 * gauss(generator);
    }
    grid.add(s);
  }
  const WhiteNoise noise = measure_white_noise(grid);
  EXPECT_NEAR(noise.gyro_density, 3e-4, 0.3e-4);  // 0.003 rad/s per sample at 100 Hz
  EXPECT_NEAR(noise.accel_density, 9e-3, 0.9e-3);
}

PoseTrack loop_track() {
  PoseTrack t;
  for (int k = 0; k <= 6000; ++k) {
    const double s = 0.01 * k;
    t.position.emplace_back(20 * std::cos(0.1 * s), 12 * std::sin(0.1 * s), 0.5 * std::sin(0.2 * s));
    t.rotation.push_back(exp_so3(Eigen::Vector3d(0, 0, 0.1 * s)));
  }
  return t;
}

const Eigen::Vector3d kArm(-0.4, 0.1, 0.5);

std::vector<GpsPosition> fixes_of(const PoseTrack& track, const Rigid3& enu_from_world, double noise_m) {
  std::mt19937 generator(4);
  std::normal_distribution<double> gauss(0, noise_m);
  std::vector<GpsPosition> out;
  for (double t = 0; t < 60; t += 0.1)
    out.push_back({t,
                   enu_from_world * (track.pose(t) * kArm) +
                       Eigen::Vector3d(gauss(generator), gauss(generator), gauss(generator)),
                   0.5, 1.0});
  return out;
}

const Rigid3 kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(1.234, Eigen::Vector3d::UnitZ())), {10, -20, 5}};

TEST(GpsAlignment, FindsYawAndTranslationThroughTheLeverArm) {
  const PoseTrack track = loop_track();
  const GpsAlignment a = align_to_gps(track, fixes_of(track, kTruth, 1e-12), kArm, GpsOptions());
  ASSERT_TRUE(a.solved);
  EXPECT_LT(a.enu_from_world.rotation.angularDistance(kTruth.rotation), 1e-7);
  EXPECT_LT((a.enu_from_world.translation - kTruth.translation).norm(), 1e-6);
}

TEST(GpsAlignment, IsNotMovedByAJumpOfFiveMetres) {
  const PoseTrack track = loop_track();
  auto fixes = fixes_of(track, kTruth, 0.2);
  for (GpsPosition& f : fixes)
    if (f.time_s > 20 && f.time_s < 30) f.enu += Eigen::Vector3d(4, 3, 0);
  const GpsAlignment a = align_to_gps(track, fixes, kArm, GpsOptions());
  ASSERT_TRUE(a.solved);
  // A sixth of the fixes is off by 5 m; plain least squares would move by 0.83 m.
  EXPECT_LT(((a.enu_from_world.inverse() * kTruth).translation).norm(), 0.15);
}

TEST(GpsAlignment, DoesNotClaimAYawForAVehicleThatStoodStillOrHadTooFewFixes) {
  PoseTrack track = loop_track();
  auto fixes = fixes_of(track, kTruth, 0.2);
  EXPECT_FALSE(align_to_gps(track, std::span(fixes).first(10), kArm, GpsOptions()).solved);
  for (auto& p : track.position) p.setZero();
  EXPECT_FALSE(align_to_gps(track, fixes, kArm, GpsOptions()).solved);
}

TEST(GpsOffset, IsFoundThroughAWanderingBiasAndAJump) {
  const PoseTrack track = loop_track();
  auto fixes = fixes_of(track, Rigid3(), 0.03);
  for (GpsPosition& f : fixes) {
    f.enu += Eigen::Vector3d(0.5 * std::sin(0.05 * f.time_s), 0.4 * std::cos(0.04 * f.time_s), 0);
    if (f.time_s > 31 && f.time_s < 36) f.enu.x() += 5;
    f.time_s -= 0.25;  // stamped a quarter of a second early
  }
  const GpsOffsetFit fit = fit_gps_offset(track, fixes, kArm);
  ASSERT_TRUE(fit.solved);
  EXPECT_NEAR(fit.offset_s, 0.25, 3 * fit.sigma_s + 0.01);
  EXPECT_LT(fit.sigma_s, 0.08);
}

TEST(GpsOffset, IsNotClaimedForAStraightDrive) {
  PoseTrack track = loop_track();
  for (int k = 0; k < track.size(); ++k)
    track.position[k] = Eigen::Vector3d(0.015 * k, 0, 0), track.rotation[k] = Eigen::Quaterniond::Identity();
  EXPECT_FALSE(fit_gps_offset(track, fixes_of(track, Rigid3(), 0.03), kArm).solved);
}

TEST(CollectFixes, RefusesWhatIsNoPositionAndFloorsOptimisticCovariances) {
  Rig rig;
  rig.gps.emplace();
  std::vector<GpsFix> fixes(5);
  for (int k = 0; k < 5; ++k) {
    fixes[k].time_s = 100 + k;
    fixes[k].latitude_deg = -35, fixes[k].longitude_deg = 138, fixes[k].height_m = 50;
    fixes[k].covariance_type = 2;
    fixes[k].covariance_enu_m2 = 1e-6 * Eigen::Matrix3d::Identity();
  }
  fixes[1].status = -1;
  fixes[2].latitude_deg = std::numeric_limits<double>::quiet_NaN();
  fixes[3].latitude_deg = fixes[3].longitude_deg = 0;
  const GpsTrack track = collect_fixes(fixes, rig, 90, 110, 90, GpsOptions());
  ASSERT_EQ(track.positions.size(), 2u);
  EXPECT_EQ(track.invalid, 3u);
  EXPECT_EQ(track.positions[0].sigma_horizontal_m, GpsOptions().min_sigma_m);
  EXPECT_NEAR(track.positions[1].time_s, 14, 1e-12);
}

TEST(MapTrajectory, CarriesConvergenceAndScaleOfTheGrid) {
  // 500 m of track northwards near the edge of a zone, compared with the projection of each point.
  const TangentPlane plane({-35.2186, 138.5411, 82});
  const auto frame = MapFrame::create("EPSG:7854");
  ASSERT_TRUE(frame);
  PoseTrack track;
  for (int k = 0; k <= 500; ++k)
    track.position.emplace_back(0, k, 0), track.rotation.emplace_back(Eigen::Quaterniond::Identity());
  const Trajectory t = map_trajectory(track, 0, plane, *frame);
  const Eigen::Vector3d far = frame->map_from_geodetic(plane.geodetic_from_enu({0, 500, 0}));
  EXPECT_LT((t.poses.back().map_from_body.translation - far).norm(), 1e-6);
  // The IMU's y axis points to true north: on the grid it shows the convergence.
  const Eigen::Vector3d north = t.poses.front().map_from_body.rotation * Eigen::Vector3d::UnitY();
  const double convergence = frame->convergence_rad(t.poses.front().map_from_body.translation);
  EXPECT_NEAR(std::atan2(north.x(), north.y()), -convergence, 2e-5);
  EXPECT_GT(std::abs(convergence), 0.02);
  // Grid metres per metre on the ground: the scale on the ellipsoid, and the height of 82 m above it.
  EXPECT_NEAR(t.horizontal_scale, frame->scale_factor(far) * (1 - 82 / 6.371e6), 1e-6);
}

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

TEST(ReportJson, IsJsonWhateverStandsInItsTexts) {
  SlamReport r;
  r.frame_note = "quote \" backslash \\ newline \n bell \a end";
  r.surfel_thickness_m = std::numeric_limits<double>::quiet_NaN();
  r.warnings = {"a", "b\tc"};
  r.uncertainty.push_back({1.5e9, {0.01, 0.02, 0.03}, {1e-3, 2e-3, 3e-3}});
  r.stages.push_back({"stage", 2.0, 50.0});
  const auto j = nlohmann::json::parse(report_json(r));
  EXPECT_EQ(j["frame"], r.frame_note);
  EXPECT_TRUE(j["surfel_thickness_m"].is_null());
  EXPECT_EQ(j["warnings"].size(), 2u);
  EXPECT_DOUBLE_EQ(j["uncertainty"][0]["translation_m"][2], 0.03);
  EXPECT_DOUBLE_EQ(j["stages"][0]["real_time_factor"], 50.0);
}

}  // namespace
}  // namespace rayfield::slam
