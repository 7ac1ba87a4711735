#include <gtest/gtest.h>

#include <limits>

#include "rayfield/slam/slam.h"
#include "tests/libslam/synthetic_scene.h"

// Logs that are broken in one way each: one clear line and the right code, or what can be recovered.
namespace rayfield::slam {
namespace {

using testing::SceneOptions;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

SceneOptions short_scene() { return testing::short_scene(12, 3); }

Result<SlamResult> reconstruct(const SceneOptions& scene, const Rig& rig = testing::scene_rig()) {
  Progress progress;
  return run_slam(
      [&](SensorSink& sink) -> Result<void> {
        testing::feed_scene(sink, rig, scene);
        return {};
      },
      rig, "", SlamOptions(), progress);
}

void expect_bad_input(const Result<SlamResult>& result, const std::string& part) {
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::bad_input);
  EXPECT_NE(result.error().line().find(part), std::string::npos) << result.error().line();
}

TEST(BrokenLog, WithoutLidarIsRefused) {
  SceneOptions scene = short_scene();
  scene.lidar = false;
  expect_bad_input(reconstruct(scene), "no lidar data");
}

TEST(BrokenLog, WithoutImuIsRefused) {
  SceneOptions scene = short_scene();
  scene.imu = false;
  expect_bad_input(reconstruct(scene), "no IMU data");
}

TEST(BrokenLog, WithNothingInItIsRefused) {
  SceneOptions scene = short_scene();
  scene.imu = scene.lidar = scene.gps = scene.spinner = false;
  expect_bad_input(reconstruct(scene), "no IMU data");
}

TEST(BrokenLog, WithoutSpinnerAnglesIsRefused) {
  SceneOptions scene = short_scene();
  scene.spinner = false;
  expect_bad_input(reconstruct(scene), "no spinner angles");
}

TEST(BrokenLog, WithAStuckSpinnerIsRefused) {
  SceneOptions scene = short_scene();
  scene.spinner_rate_rad_s = 0;
  expect_bad_input(reconstruct(scene), "stuck");
}

TEST(BrokenLog, WithOnlyNanRangesIsRefused) {
  SceneOptions scene = short_scene();
  scene.edit_lidar = [](LidarScan& scan) {
    scan.range_m.assign(scan.range_m.size(), std::numeric_limits<float>::quiet_NaN());
    return true;
  };
  expect_bad_input(reconstruct(scene), "not one lidar point");
}

TEST(BrokenLog, WithOnlyNanImuSamplesIsRefused) {
  SceneOptions scene = short_scene();
  scene.edit_imu = [](ImuSample& s) {
    s.linear_acceleration_m_s2.setConstant(kNan);
    return true;
  };
  expect_bad_input(reconstruct(scene), "NaN");
}

TEST(BrokenLog, WithAnImuInUnitsOfGravityIsRefused) {
  SceneOptions scene = short_scene();
  scene.edit_imu = [](ImuSample& s) {
    s.linear_acceleration_m_s2 /= 9.81;
    return true;
  };
  expect_bad_input(reconstruct(scene), "specific force");
}

TEST(BrokenLog, ShorterThanAWindowIsRefused) {
  SceneOptions scene = short_scene();
  scene.duration_s = 3;
  expect_bad_input(reconstruct(scene), "5 s");
}

TEST(BrokenLog, WithUnequalColumnsInScansIsRefusedAndDoesNotCrash) {
  SceneOptions scene = short_scene();
  scene.edit_lidar = [](LidarScan& scan) {
    scan.time_offset_s.pop_back();
    return true;
  };
  expect_bad_input(reconstruct(scene), "lidar");
}

TEST(DamagedLog, WithSingleNansDuplicatesAndStraysIsReconstructed) {
  SceneOptions scene = short_scene();
  int count = 0;
  scene.edit_imu = [&count](ImuSample& s) {
    ++count;
    if (count % 100 == 7) s.angular_velocity_rad_s.x() = kNan;  // one in a hundred is NaN
    if (count % 100 == 57) s.time_s -= 0.01;                    // one repeats the stamp before it
    if (count == 500) s.time_s += 3600;                         // a single stray
    return true;
  };
  scene.edit_lidar = [](LidarScan& scan) {
    scan.range_m[3] = std::numeric_limits<float>::quiet_NaN();
    return true;
  };
  scene.edit_gps = [](GpsFix& fix) {
    if (std::fmod(fix.time_s, 1.0) < 0.05) fix.latitude_deg = kNan;
    return true;
  };
  const auto result = reconstruct(scene);
  ASSERT_TRUE(result) << result.error().line();
  EXPECT_NEAR(result->report.end_s - result->report.start_s, 12, 0.2);
  EXPECT_GE(result->report.warnings.size(), 3u);
}

TEST(DamagedLog, WithAClockJumpOfAnHourGivesTheLongerPartAndSaysSo) {
  SceneOptions scene = short_scene();
  scene.duration_s = 22;
  const double jump_at = testing::kStart + 7;
  const auto jump = [&](double& time) {
    if (time > jump_at) time += 3600;
  };
  scene.edit_imu = [&](ImuSample& s) {
    jump(s.time_s);
    return true;
  };
  scene.edit_lidar = [&](LidarScan& s) {
    jump(s.time_s);
    return true;
  };
  scene.edit_gps = [&](GpsFix& s) {
    jump(s.time_s);
    return true;
  };
  const Rig rig = testing::scene_rig(false);
  scene.spins = false;
  const auto result = reconstruct(scene, rig);
  ASSERT_TRUE(result) << result.error().line();
  EXPECT_GT(result->report.start_s, jump_at + 3599);
  EXPECT_NEAR(result->report.end_s - result->report.start_s, 15, 0.5);
  bool reported = false;
  for (const std::string& w : result->report.warnings) reported |= w.find("2 sections") != std::string::npos;
  EXPECT_TRUE(reported);
}

TEST(DamagedLog, WithExtrinsicsThatAreWrongIsNotMadeIntoAPrettyMap) {
  SceneOptions scene = short_scene();
  Rig rig = testing::scene_rig();
  Rig wrong = rig;
  wrong.imu_from_spinner.rotation = exp_so3({0.35, 0, 0}) * wrong.imu_from_spinner.rotation;
  Progress progress;
  const auto result = run_slam(
      [&](SensorSink& sink) -> Result<void> {
        testing::feed_scene(sink, rig, scene);
        return {};
      },
      wrong, "", SlamOptions(), progress);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::bad_input);
}

TEST(Slam, StopsWhenAsked) {
  struct Stop : Progress {
    bool cancelled() const override { return true; }
  } stop;
  const Rig rig = testing::scene_rig();
  const auto result = run_slam(
      [&](SensorSink& sink) -> Result<void> {
        testing::feed_scene(sink, rig, short_scene());
        return {};
      },
      rig, "", SlamOptions(), stop);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::interrupted);
}

TEST(Slam, RefusesOptionsOutsideTheirRange) {
  SlamOptions options;
  options.window.knot_step_s = -1;
  Progress progress;
  const auto result =
      run_slam([](SensorSink&) -> Result<void> { return {}; }, testing::scene_rig(), "", options, progress);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_NE(result.error().line().find("window.knot_step_s"), std::string::npos);
}

TEST(Slam, RefusesAGeographicCrs) {
  Progress progress;
  const auto result = run_slam([](SensorSink&) -> Result<void> { return {}; }, testing::scene_rig(), "EPSG:4326",
                               SlamOptions(), progress);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::slam
