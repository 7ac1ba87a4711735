#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "rayfield/slam/slam.h"
#include "tests/libslam/synthetic_scene.h"

namespace rayfield::slam {
namespace {

using testing::SceneOptions;

struct Errors {
  double rms_m = 0, max_m = 0, rotation_max_rad = 0;
};

// Against truth after the best yaw and translation.
Errors compare(const Trajectory& trajectory, double rest_s) {
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
  std::vector<Rigid3> truth;
  for (const TimedPose& p : trajectory.poses) {
    truth.push_back(testing::scene_pose(p.time_s - testing::kStart, rest_s));
    a += p.map_from_body.translation, b += truth.back().translation;
  }
  const double n = static_cast<double>(truth.size());
  a /= n, b /= n;
  double c = 0, s = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Eigen::Vector3d x = trajectory.poses[k].map_from_body.translation - a, y = truth[k].translation - b;
    c += x.head<2>().dot(y.head<2>()), s += x.x() * y.y() - x.y() * y.x();
  }
  const Eigen::Quaterniond yaw(Eigen::AngleAxisd(std::atan2(s, c), Eigen::Vector3d::UnitZ()));
  Errors out;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double e = (yaw * (trajectory.poses[k].map_from_body.translation - a) - (truth[k].translation - b)).norm();
    out.rms_m += e * e / n;
    out.max_m = std::max(out.max_m, e);
    out.rotation_max_rad = std::max(
        out.rotation_max_rad, (yaw * trajectory.poses[k].map_from_body.rotation).angularDistance(truth[k].rotation));
  }
  out.rms_m = std::sqrt(out.rms_m);
  return out;
}

Result<SlamResult> reconstruct(const SceneOptions& scene, int threads = 1, const std::string& crs = "",
                               SlamOptions options = {}) {
  const Rig rig = testing::scene_rig(scene.spins);
  options.threads = threads;
  Progress progress;
  return run_slam(
      [&](SensorSink& sink) -> Result<void> {
        testing::feed_scene(sink, rig, scene);
        return {};
      },
      rig, crs, options, progress);
}

TEST(NoiseFreeScene, IsRecoveredToMillimetres) {
  const auto result = reconstruct({});
  ASSERT_TRUE(result) << result.error().line();
  const Errors e = compare(result->trajectory, 6);
  EXPECT_LT(e.rms_m, 0.004);
  EXPECT_LT(e.max_m, 0.010);
  EXPECT_LT(e.rotation_max_rad, 0.002);
  EXPECT_NEAR(result->report.stationary_start_s, 6, 1.0);
  EXPECT_LT(result->report.surfel_thickness_m, 0.004);
  EXPECT_LT((result->report.gyro_bias_rad_s - SceneOptions().gyro_bias).norm(), 5e-4);
  EXPECT_LT((result->report.accel_bias_m_s2 - SceneOptions().accel_bias).norm(), 0.02);
}

TEST(NoiseFreeScene, IsRecoveredFromAStartInMotion) {
  SceneOptions scene;
  scene.rest_s = 0;
  const auto result = reconstruct(scene);
  ASSERT_TRUE(result) << result.error().line();
  EXPECT_EQ(result->report.stationary_start_s, 0);
  EXPECT_LT(compare(result->trajectory, 0).rms_m, 0.01);
}

TEST(NoiseFreeScene, IsRecoveredWithAFixedMultiBeamLidar) {
  SceneOptions scene;
  scene.spins = false;
  const auto result = reconstruct(scene);
  ASSERT_TRUE(result) << result.error().line();
  EXPECT_LT(compare(result->trajectory, 6).rms_m, 0.005);
}

// A sample that is nonsense, as electric noise or a lost byte makes it: what it says must not enter the path.
TEST(NoiseFreeScene, IsRecoveredInSpiteOfSpikesOfTheImu) {
  SceneOptions scene;
  int count = 0;
  scene.edit_imu = [&count](ImuSample& s) {
    ++count;
    if (count == 1500) s.angular_velocity_rad_s.z() += 20;
    if (count == 2200) s.linear_acceleration_m_s2.x() -= 150;
    if (count == 2900) s.angular_velocity_rad_s.x() -= 35, s.linear_acceleration_m_s2.z() = 0;
    return true;
  };
  const auto result = reconstruct(scene);
  ASSERT_TRUE(result) << result.error().line();
  const Errors e = compare(result->trajectory, scene.rest_s);
  EXPECT_LT(e.max_m, 0.01);
  EXPECT_TRUE(std::any_of(result->report.warnings.begin(), result->report.warnings.end(),
                          [](const std::string& w) { return w.find("spikes") != std::string::npos; }));
}

// Four samples are no spike any more; what they say bends the path, and surfaces seen before and after contradict it.
TEST(NoiseFreeScene, IsRefusedWhereTheGyroscopeWasDisturbed) {
  SceneOptions scene;
  int count = 0;
  scene.edit_imu = [&count](ImuSample& s) {
    ++count;
    if (count >= 1500 && count < 1504) s.angular_velocity_rad_s.z() += 20;
    return true;
  };
  const auto result = reconstruct(scene);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::bad_input);
  EXPECT_NE(result.error().line().find("s after its start"), std::string::npos) << result.error().line();
}

TEST(NoiseFreeScene, GivesTheSameBytesAtOneAndTwoThreads) {
  SceneOptions scene;
  scene.duration_s = 20;
  const auto one = reconstruct(scene, 1), two = reconstruct(scene, 2);
  ASSERT_TRUE(one && two);
  ASSERT_EQ(one->trajectory.poses.size(), two->trajectory.poses.size());
  for (std::size_t k = 0; k < one->trajectory.poses.size(); ++k) {
    const TimedPose &a = one->trajectory.poses[k], &b = two->trajectory.poses[k];
    ASSERT_EQ(std::memcmp(a.map_from_body.translation.data(), b.map_from_body.translation.data(), 24), 0) << k;
    ASSERT_EQ(std::memcmp(a.map_from_body.rotation.coeffs().data(), b.map_from_body.rotation.coeffs().data(), 32), 0)
        << k;
  }
}

TEST(NoiseFreeScene, LandsOnItsMapCoordinatesWithExactGps) {
  const auto result = reconstruct({}, 1, "EPSG:7854");
  ASSERT_TRUE(result) << result.error().line();
  EXPECT_TRUE(result->report.georeferenced);
  const auto frame = MapFrame::create("EPSG:7854");
  ASSERT_TRUE(frame);
  const TangentPlane plane(testing::kSceneOrigin);
  double worst = 0;
  for (const TimedPose& p : result->trajectory.poses) {
    const Eigen::Vector3d enu = testing::scene_pose(p.time_s - testing::kStart, 6).translation;
    worst =
        std::max(worst, (frame->map_from_geodetic(plane.geodetic_from_enu(enu)) - p.map_from_body.translation).norm());
  }
  EXPECT_LT(worst, 0.02);
}

TEST(NoiseFreeScene, StaysLocalWithoutGpsAndSaysSo) {
  SceneOptions scene;
  scene.gps = false;
  scene.duration_s = 15;
  const auto result = reconstruct(scene, 1, "EPSG:7854");
  ASSERT_TRUE(result) << result.error().line();
  EXPECT_FALSE(result->report.georeferenced);
  EXPECT_TRUE(result->trajectory.crs.empty());
  EXPECT_NE(result->report.frame_note.find("nothing is georeferenced"), std::string::npos);
}

}  // namespace
}  // namespace rayfield::slam
