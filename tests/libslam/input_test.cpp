#include <gtest/gtest.h>

#include <limits>

#include "rayfield/slam/slam.h"
#include "tests/libslam/synthetic_room.h"

// Logs that are broken in one way each: one clear line and the right code, or what can be recovered.
namespace rayfield::slam {
namespace {

using testing::RoomOptions;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

RoomOptions short_room() {
  RoomOptions room;
  room.duration_s = 12;
  room.rest_s = 3;
  return room;
}

Result<SlamResult> reconstruct(const RoomOptions& room, const Rig& rig = testing::room_rig()) {
  Progress progress;
  return run_slam(
      [&](SensorSink& sink) -> Result<void> {
        testing::feed_room(sink, rig, room);
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
  RoomOptions room = short_room();
  room.lidar = false;
  expect_bad_input(reconstruct(room), "no lidar data");
}

TEST(BrokenLog, WithoutImuIsRefused) {
  RoomOptions room = short_room();
  room.imu = false;
  expect_bad_input(reconstruct(room), "no IMU data");
}

TEST(BrokenLog, WithNothingInItIsRefused) {
  RoomOptions room = short_room();
  room.imu = room.lidar = room.gps = room.spinner = false;
  expect_bad_input(reconstruct(room), "no IMU data");
}

TEST(BrokenLog, WithoutSpinnerAnglesIsRefused) {
  RoomOptions room = short_room();
  room.spinner = false;
  expect_bad_input(reconstruct(room), "no spinner angles");
}

TEST(BrokenLog, WithAStuckSpinnerIsRefused) {
  RoomOptions room = short_room();
  room.spinner_rate_rad_s = 0;
  expect_bad_input(reconstruct(room), "stuck");
}

TEST(BrokenLog, WithOnlyNanRangesIsRefused) {
  RoomOptions room = short_room();
  room.edit_lidar = [](LidarScan& scan) {
    scan.range_m.assign(scan.range_m.size(), std::numeric_limits<float>::quiet_NaN());
    return true;
  };
  expect_bad_input(reconstruct(room), "not one lidar point");
}

TEST(BrokenLog, WithOnlyNanImuSamplesIsRefused) {
  RoomOptions room = short_room();
  room.edit_imu = [](ImuSample& s) {
    s.linear_acceleration_m_s2.setConstant(kNan);
    return true;
  };
  expect_bad_input(reconstruct(room), "NaN");
}

TEST(BrokenLog, WithAnImuInUnitsOfGravityIsRefused) {
  RoomOptions room = short_room();
  room.edit_imu = [](ImuSample& s) {
    s.linear_acceleration_m_s2 /= 9.81;
    return true;
  };
  expect_bad_input(reconstruct(room), "specific force");
}

TEST(BrokenLog, ShorterThanAWindowIsRefused) {
  RoomOptions room = short_room();
  room.duration_s = 3;
  expect_bad_input(reconstruct(room), "5 s");
}

TEST(BrokenLog, WithUnequalColumnsInScansIsRefusedAndDoesNotCrash) {
  RoomOptions room = short_room();
  room.edit_lidar = [](LidarScan& scan) {
    scan.time_offset_s.pop_back();
    return true;
  };
  expect_bad_input(reconstruct(room), "lidar");
}

TEST(DamagedLog, WithSingleNansDuplicatesAndStraysIsReconstructed) {
  RoomOptions room = short_room();
  int count = 0;
  room.edit_imu = [&count](ImuSample& s) {
    ++count;
    if (count % 100 == 7) s.angular_velocity_rad_s.x() = kNan;  // one in a hundred is NaN
    if (count % 100 == 57) s.time_s -= 0.01;                    // one repeats the stamp before it
    if (count == 500) s.time_s += 3600;                         // a single stray
    return true;
  };
  room.edit_lidar = [](LidarScan& scan) {
    scan.range_m[3] = std::numeric_limits<float>::quiet_NaN();
    return true;
  };
  room.edit_gps = [](GpsFix& fix) {
    if (std::fmod(fix.time_s, 1.0) < 0.05) fix.latitude_deg = kNan;
    return true;
  };
  const auto result = reconstruct(room);
  ASSERT_TRUE(result) << result.error().line();
  EXPECT_NEAR(result->report.end_s - result->report.start_s, 12, 0.2);
  EXPECT_GE(result->report.warnings.size(), 3u);
}

TEST(DamagedLog, WithAClockJumpOfAnHourGivesTheLongerPartAndSaysSo) {
  RoomOptions room = short_room();
  room.duration_s = 22;
  const double jump_at = testing::kStart + 7;
  const auto jump = [&](double& time) {
    if (time > jump_at) time += 3600;
  };
  room.edit_imu = [&](ImuSample& s) {
    jump(s.time_s);
    return true;
  };
  room.edit_lidar = [&](LidarScan& s) {
    jump(s.time_s);
    return true;
  };
  room.edit_gps = [&](GpsFix& s) {
    jump(s.time_s);
    return true;
  };
  const Rig rig = testing::room_rig(false);
  room.spins = false;
  const auto result = reconstruct(room, rig);
  ASSERT_TRUE(result) << result.error().line();
  EXPECT_GT(result->report.start_s, jump_at + 3599);
  EXPECT_NEAR(result->report.end_s - result->report.start_s, 15, 0.5);
  bool said = false;
  for (const std::string& w : result->report.warnings) said |= w.find("2 drives") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST(DamagedLog, WithExtrinsicsThatAreWrongIsNotMadeIntoAPrettyMap) {
  RoomOptions room = short_room();
  Rig rig = testing::room_rig();
  Rig wrong = rig;
  wrong.imu_from_spinner.rotation = exp_so3({0.35, 0, 0}) * wrong.imu_from_spinner.rotation;
  Progress progress;
  const auto result = run_slam(
      [&](SensorSink& sink) -> Result<void> {
        testing::feed_room(sink, rig, room);
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
  const Rig rig = testing::room_rig();
  const auto result = run_slam(
      [&](SensorSink& sink) -> Result<void> {
        testing::feed_room(sink, rig, short_room());
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
      run_slam([](SensorSink&) -> Result<void> { return {}; }, testing::room_rig(), "", options, progress);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_NE(result.error().line().find("window.knot_step_s"), std::string::npos);
}

TEST(Slam, RefusesAGeographicCrs) {
  Progress progress;
  const auto result = run_slam([](SensorSink&) -> Result<void> { return {}; }, testing::room_rig(), "EPSG:4326",
                               SlamOptions(), progress);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::slam
