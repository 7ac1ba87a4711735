#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rayfield/formats/log_info.h"
#include "rayfield/formats/rig_file.h"
#include "rayfield/formats/sensor_log.h"
#include "rayfield/formats/trajectory_file.h"
#include "tests/formats/bag_bytes.h"

/// Logs of real and simulated drives, with what is known of them from elsewhere (their README, their truth).
namespace rayfield::formats {
namespace {

using ::testing::HasSubstr;

struct Counter : SensorSink {
  std::size_t imus = 0, fixes = 0, angles = 0, scans = 0, beams = 0;
  double last_angle = 0, turned_rad = 0;
  Eigen::Vector3d first_acceleration = Eigen::Vector3d::Zero();
  GpsFix first_fix;
  bool regular = true;
  void imu(const ImuSample& sample) override {
    if (imus++ == 0) first_acceleration = sample.linear_acceleration_m_s2;
  }
  void gps(const GpsFix& fix) override {
    if (fixes++ == 0) first_fix = fix;
  }
  void spinner(const SpinnerAngle& angle) override {
    if (angles++ > 0) turned_rad += std::remainder(angle.angle_rad - last_angle, 2 * M_PI);
    last_angle = angle.angle_rad;
  }
  void lidar(const LidarScan& scan) override {
    ++scans;
    beams += scan.range_m.size();
    regular =
        regular && scan.direction.size() == scan.range_m.size() && scan.time_offset_s.size() == scan.range_m.size();
  }
};

class SharedLogs : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = bytes::shared_folder();
    if (folder_.empty()) GTEST_SKIP() << "the shared test data are not here; set RAYFIELD_SHARED";
  }
  std::string folder_;
};

TEST_F(SharedLogs, BlockAIsReadWholeForBothDates) {
  // 100 Hz for the duration that the truth states, 286 beams, 10 Hz GPS, 0.5 Hz spin; NaN is the only invalid range.
  for (const auto& [date, duration_s] : {std::pair("2019-02-11", 114.99), std::pair("2018-12-12", 0.0)}) {
    const std::string block = folder_ + "/block_a/" + date;
    const auto rig = read_rig(block + "/rig.toml");
    ASSERT_TRUE(rig) << rig.error().line();
    const auto truth = read_trajectory(block + "/truth/trajectory.tum");
    ASSERT_TRUE(truth) << truth.error().line();
    Counter counter;
    const auto report = read_log(block + "/scan.bag", *rig, counter);
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_TRUE(report->warnings().empty());
    EXPECT_TRUE(report->bag.indexed);
    const double recorded_s = report->topic(SensorKind::imu).last_s - report->topic(SensorKind::imu).first_s;
    const double driven_s = truth->poses.back().time_s - truth->poses.front().time_s;
    EXPECT_NEAR(recorded_s, driven_s, 0.5);
    if (duration_s > 0) {
      EXPECT_NEAR(recorded_s, duration_s, 0.5);
    }
    EXPECT_NEAR(static_cast<double>(counter.imus), recorded_s * 100, 2);
    EXPECT_EQ(counter.scans, counter.imus);
    EXPECT_EQ(counter.angles, counter.imus);
    EXPECT_NEAR(static_cast<double>(counter.fixes), recorded_s * 10, 2);
    EXPECT_EQ(counter.beams, counter.scans * 286);
    EXPECT_TRUE(counter.regular);
    EXPECT_NEAR(std::abs(counter.turned_rad), M_PI * recorded_s, 0.1 * M_PI);
    EXPECT_NEAR(counter.first_acceleration.norm(), 9.81, 0.5);
    EXPECT_NEAR(counter.first_fix.latitude_deg, -35.2186, 1e-3);
    EXPECT_NEAR(counter.first_fix.longitude_deg, 138.5411, 1e-3);
  }
}

TEST_F(SharedLogs, ACutDriveGivesEverythingUpToTheCut) {
  const std::string path = folder_ + "/block_a/2019-02-11/scan.bag";
  const std::string whole = bytes::read_file(path);
  const std::size_t kept = 20'000'000;
  const bytes::TemporaryFile cut(whole.substr(0, kept));
  const auto rig = read_rig(folder_ + "/block_a/2019-02-11/rig.toml");
  Counter counter;
  const auto report = read_log(cut.path(), *rig, counter);
  ASSERT_TRUE(report) << report.error().line();
  const double share = static_cast<double>(kept) / static_cast<double>(whole.size());
  EXPECT_NEAR(static_cast<double>(counter.scans), share * 11477, 0.01 * 11477);
  EXPECT_NEAR(report->bag.lost_s, (1 - share) * 114.77, 0.03 * 114.77);
  EXPECT_NEAR(static_cast<double>(report->bag.lost_bytes), static_cast<double>(whole.size() - kept), 100e3);
  EXPECT_THAT(report->warnings(), ::testing::Contains(HasSubstr("lost at byte")));
}

TEST_F(SharedLogs, ARealRobotWithoutALidarIsUnderstood) {
  const std::string path = folder_ + "/rosbag/husky_imu_gps_odom.bag";
  const auto info = inspect_log(path);
  ASSERT_TRUE(info) << info.error().line();
  ASSERT_EQ(info->topics.size(), 3U);
  EXPECT_EQ(info->topics[0].topic, "/fix");
  EXPECT_EQ(info->topics[0].messages, 989U);
  EXPECT_EQ(info->topics[1].type, "nav_msgs/Odometry");
  EXPECT_EQ(info->topics[2].messages, 11865U);
  EXPECT_NEAR(info->topics[2].rate_hz, 30.0, 0.5);
  EXPECT_NEAR(info->duration_s, 395.307, 0.01);
  ASSERT_EQ(info->gps.size(), 1U);
  EXPECT_NEAR(info->gps[0].south_deg, 42.375, 0.005);
  EXPECT_NEAR(info->gps[0].west_deg, -71.147, 0.005);
  EXPECT_THAT(info->problems(), ::testing::Contains(HasSubstr("no lidar")));
  Rig rig;
  rig.gps = Rig::Gps{"/fix"};
  LogOptions options;
  Counter counter;
  EXPECT_EQ(read_log(path, rig, counter, options).error().code, ErrorCode::bad_input);
  options.require_lidar = false;
  const auto report = read_log(path, rig, counter, options);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(counter.imus + report->topic(SensorKind::imu).duplicates + report->topic(SensorKind::imu).late, 11865U);
  EXPECT_EQ(counter.fixes, 989U);
}

TEST_F(SharedLogs, RawPacketsAreRefusedByName) {
  const std::string path = folder_ + "/rosbag/ouster_512x10_raw.bag";
  Counter counter;
  const auto report = read_log(path, Rig(), counter);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::bad_input);
  EXPECT_THAT(report.error().line(), HasSubstr("raw packets: /os_node0/imu_packets (ouster_ros/PacketMsg), "
                                               "/os_node0/lidar_packets (ouster_ros/PacketMsg)"));
  Rig rig;
  rig.lidar.topic = "/os_node0/lidar_packets";
  rig.imu.topic = "/os_node0/imu_packets";
  EXPECT_THAT(read_log(path, rig, counter).error().line(), HasSubstr("raw packets (ouster_ros/PacketMsg)"));
  const auto info = inspect_log(path);
  ASSERT_TRUE(info) << info.error().line();
  EXPECT_THAT(info->problems(), ::testing::Contains(HasSubstr("play the bag through the sensor's ROS driver")));
}

}  // namespace
}  // namespace rayfield::formats
