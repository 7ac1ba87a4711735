#include "rayfield/formats/sensor_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>

#include "rayfield/formats/sensor_log_writer.h"
#include "tests/formats/sensor_log_support.h"

namespace rayfield::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(SensorLog, DecodesEverySensorFromItsBytes) {
  Collected got;
  const ScanNumbers numbers{-1.0, 0.5, 1e-4, 0.1, 40};
  const auto report = read(connections() + message(0, 100, 1, imu(100, 500000000, 0.7, 9.5)) +
                               message(1, 100, 2, fix(100, 250000000, 1, -35.5, 138.25, 90.125)) +
                               message(2, 100, 3, joints(100, 125000000, {"wheel", "spinner"}, {7.0, 1.25})) +
                               message(3, 100, 4, scan(100, 0, numbers, {3.0, 4.0, 5.0}, {10, 20, 30})),
                           full_rig(), got);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(got.order, "igsl");
  EXPECT_EQ(got.imus[0].time_s, 100.5);
  EXPECT_EQ(got.imus[0].angular_velocity_rad_s, Eigen::Vector3d(0.7, 0.2, 0.3));
  EXPECT_EQ(got.imus[0].linear_acceleration_m_s2, Eigen::Vector3d(0.4, 0.5, 9.5));
  EXPECT_EQ(got.fixes[0].time_s, 100.25);
  EXPECT_EQ(got.fixes[0].latitude_deg, -35.5);
  EXPECT_EQ(got.fixes[0].longitude_deg, 138.25);
  EXPECT_EQ(got.fixes[0].height_m, 90.125);
  EXPECT_EQ(got.fixes[0].covariance_enu_m2(0, 1), 0.01);
  EXPECT_EQ(got.fixes[0].covariance_enu_m2(2, 2), 0.81);
  EXPECT_EQ(got.fixes[0].covariance_type, 3);
  EXPECT_EQ(got.angles[0].time_s, 100.125);
  EXPECT_EQ(got.angles[0].angle_rad, 1.25);
  EXPECT_THAT(got.scans[0].range_m, ElementsAre(3.0F, 4.0F, 5.0F));
  EXPECT_THAT(got.scans[0].intensity, ElementsAre(10.0F, 20.0F, 30.0F));
  EXPECT_NEAR(got.scans[0].direction[0].y(), std::sin(-1.0), 1e-7);
  EXPECT_NEAR(got.scans[0].direction[2].x(), 1.0, 1e-7);
  EXPECT_NEAR(got.scans[0].time_offset_s[2], 2e-4, 1e-10);
  EXPECT_TRUE(report->topic(SensorKind::gps).longest_gap_s == 0 && report->segments.size() == 1);
}

TEST(SensorLog, CountsMalformedMessagesAndGoesOn) {
  const std::string good = imu(1, 0);
  const std::string fields_lie = header(1, 0) + u32(1) + u32(1) + u32(0xffffffffU);
  const std::string ranges_lie = header(1, 0) + floats({0, 0, 0, 0, 0, 0, 0}) + u32(0xffffffffU) + f32(1);
  Collected got;
  const auto report = read(connections() + message(0, 1, 0, good) + message(0, 2, 0, imu(2, 0).substr(0, 100)) +
                               message(0, 3, 0, imu(3, 0) + "x") + message(0, 4, 0, "") + message(0, 5, 0, imu(5, 0)) +
                               message(3, 6, 0, ranges_lie) + message(3, 7, 0, scan(7, 0, {}, {1.0})),
                           lidar_rig(), got);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_THAT(times_of(got), ElementsAre(1, 5));
  EXPECT_EQ(report->topic(SensorKind::imu).undecodable, 3U);
  EXPECT_EQ(report->topic(SensorKind::lidar).undecodable, 1U);
  Collected clouds;
  const auto cloud_report =
      read(connections(kCloudType, kCloudMd5) + message(3, 1, 0, fields_lie), lidar_rig(), clouds, any_sensors());
  ASSERT_TRUE(cloud_report);
  EXPECT_EQ(cloud_report->topic(SensorKind::lidar).undecodable, 1U);
}

TEST(SensorLog, LeavesOutNaNsAndFixesWithoutAPosition) {
  Collected got;
  const auto report =
      read(connections() + message(0, 1, 0, imu(1, 0, kNaN)) + message(0, 2, 0, imu(2, 0)) +
               message(1, 3, 0, fix(3, 0, -1, 0, 0, 0)) + message(1, 4, 0, fix(4, 0, 0, kNaN, 1, 1)) +
               message(1, 5, 0, fix(5, 0, 0, 95, 1, 1)) + message(1, 6, 0, fix(6, 0, 0, 45, 1, 1)) +
               message(2, 7, 0, joints(7, 0, {"spinner"}, {kNaN})) + message(2, 8, 0, joints(8, 0, {"spinner"}, {1})) +
               message(3, 9, 0, scan(9, 0, {}, {kNaN, kNaN})) + message(3, 10, 0, scan(10, 0, {}, {kNaN, 2})),
           full_rig(), got);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(got.order, "igsl");
  EXPECT_EQ(report->topic(SensorKind::imu).invalid, 1U);
  EXPECT_EQ(report->topic(SensorKind::gps).invalid, 3U);
  EXPECT_EQ(report->topic(SensorKind::gps).without_position, 1U);
  EXPECT_EQ(report->topic(SensorKind::spinner).invalid, 1U);
  EXPECT_EQ(report->topic(SensorKind::lidar).invalid, 1U);
}

// A flipped bit in an exponent makes a finite number that no sensor on a vehicle measures.
TEST(SensorLog, LeavesOutWhatNoSensorMeasures) {
  Collected got;
  const auto report =
      read(connections() + message(0, 1, 0, imu(1, 0, 0.1, 1e200)) + message(0, 2, 0, imu(2, 0, 1e5)) +
               message(0, 3, 0, imu(3, 0, 30, 300)) + message(2, 7, 0, joints(7, 0, {"spinner"}, {1e300})) +
               message(2, 8, 0, joints(8, 0, {"spinner"}, {-2e4})) + message(3, 9, 0, scan(9, 0, {}, {2})),
           full_rig(), got);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(got.order, "isl");
  EXPECT_EQ(got.imus[0].linear_acceleration_m_s2.z(), 300);
  EXPECT_EQ(report->topic(SensorKind::imu).invalid, 2U);
  EXPECT_EQ(report->topic(SensorKind::spinner).invalid, 1U);
}

// 40 s with messages every 0.1 s; the spinner stands still from 10 to 14 s, the lidar is silent from 20 to 23 s and
// ends at 30 s, the GPS begins at 8 s.
TEST(SensorLog, SaysWhenSensorsAreSilentStuckOrNotAwakeTogether) {
  Collected got;
  std::string records = connections();
  double angle = 0;
  for (int i = 0; i < 400; ++i) {
    const auto s = static_cast<std::uint32_t>(1000 + i / 10), ns = static_cast<std::uint32_t>(i % 10) * 100'000'000;
    if (i <= 100 || i > 140) angle += 0.3;
    records += message(0, s, ns, imu(s, ns)) + message(2, s, ns, joints(s, ns, {"spinner"}, {angle}));
    if (i < 300 && (i <= 200 || i >= 230)) records += message(3, s, ns, scan(s, ns, {}, {2}));
    if (i >= 80) records += message(1, s, ns, fix(s, ns, 0, 45, 1, 1));
  }
  const auto report = read(records, full_rig(), got);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_NEAR(report->topic(SensorKind::spinner).longest_stationary_s, 4.0, 1e-6);
  EXPECT_NEAR(report->topic(SensorKind::spinner).longest_stationary_start_s, 1010.0, 1e-6);
  EXPECT_NEAR(report->topic(SensorKind::lidar).longest_gap_start_s, 1020.0, 1e-6);
  EXPECT_THAT(report->warnings(),
              ::testing::UnorderedElementsAre(
                  HasSubstr("no index"), "lidar /lidar/scan: silent for 3.0 s from 1970-01-01T00:17:00.000Z",
                  "spinner /spinner/joint_states: stands still for 4.0 s from 1970-01-01T00:16:50.000Z",
                  "lidar /lidar/scan: ends 10.0 s before the others", "GPS /gps/fix: begins 8.0 s after the others"));
}

TEST(SensorLog, AGpsTopicThatIsCalledOtherwiseIsAMistakeAndNoGpsAtAllIsNot) {
  const std::string sensors = message(0, 1, 0, imu(1, 0)) + message(3, 1, 0, scan(1, 0, {}, {2}));
  Rig rig;
  rig.gps = Rig::Gps{"/fix"};
  Collected got;
  const auto mistaken = read(connections() + sensors + message(1, 1, 0, fix(1, 0, 0, 45, 1, 1)), rig, got);
  ASSERT_FALSE(mistaken);
  EXPECT_EQ(mistaken.error().code, ErrorCode::bad_input);
  EXPECT_THAT(mistaken.error().line(), HasSubstr("choose from: /gps/fix (sensor_msgs/NavSatFix)"));
  const auto none =
      read(connection(0, "/imu/data", kImuType, kImuMd5) + connection(3, "/lidar/scan", kScanType, kScanMd5) + sensors,
           rig, got);
  EXPECT_TRUE(none) << none.error().line();
}

Error error_of(const std::string& records, const Rig& rig) {
  Collected got;
  const auto report = read(records, rig, got);
  if (report) ADD_FAILURE() << "the log was read";
  return report ? Error{} : report.error();
}

TEST(SensorLog, SaysClearlyWhatALogLacks) {
  const std::string imu_only = connection(0, "/imu/data", kImuType, kImuMd5) + imu_at(1);
  const std::string scan_message = message(3, 1, 0, scan(1, 0, {}, {1.0}));
  EXPECT_THAT(error_of("", lidar_rig()).line(), HasSubstr("the bag holds no messages"));
  EXPECT_THAT(error_of(imu_only, lidar_rig()).line(), HasSubstr("no lidar topic /lidar/scan, and no other topic"));
  EXPECT_THAT(error_of(imu_only + connection(3, "/front", kScanType, kScanMd5) + scan_message, lidar_rig()).line(),
              HasSubstr("choose from: /front (sensor_msgs/LaserScan)"));
  EXPECT_THAT(error_of(connection(3, "/lidar/scan", kScanType, kScanMd5) + scan_message, lidar_rig()).line(),
              HasSubstr("no IMU topic /imu/data"));
  EXPECT_THAT(
      error_of(imu_only + connection(5, "/packets", "ouster_ros/PacketMsg", "*") + message(5, 1, 0, "x"), lidar_rig())
          .line(),
      HasSubstr("only a sensor's raw packets: /packets (ouster_ros/PacketMsg)"));
  EXPECT_THAT(
      error_of(imu_only + connection(3, "/lidar/scan", "velodyne_msgs/VelodyneScan", "*") + scan_message, lidar_rig())
          .line(),
      HasSubstr("raw packets (velodyne_msgs/VelodyneScan)"));
  EXPECT_THAT(
      error_of(imu_only + connection(3, "/lidar/scan", "std_msgs/String", "*") + scan_message, lidar_rig()).line(),
      HasSubstr("its type std_msgs/String does not serve as lidar"));
  EXPECT_THAT(error_of(imu_only + connection(3, "/lidar/scan", kScanType, "0123") + scan_message, lidar_rig()).line(),
              HasSubstr("md5sum 0123"));
  EXPECT_THAT(error_of(connections() + imu_at(1) + message(3, 1, 0, scan(1, 0, {}, {kNaN})), lidar_rig()).line(),
              HasSubstr("not one of its 1 messages is usable (1 without a valid value"));
  EXPECT_THAT(error_of(connections() + imu_at(1) + scan_message + message(2, 2, 0, joints(2, 0, {"a", "b"}, {1, 2})),
                       full_rig())
                  .line(),
              HasSubstr("no message has the joint 'spinner'; joints there: a, b"));
}

/// Peak resident memory of this process so far, MiB.
double peak_memory_mib() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

TEST(SensorLog, MemoryDoesNotGrowWithTheLog) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep freed memory";
#endif
  const TemporaryFile small(""), large("");
  for (const auto& [file, scans] : {std::pair(&small, 500), std::pair(&large, 20000)}) {
    auto writer = SensorLogWriter::create(file->path(), lidar_rig());
    const std::vector<float> ranges(1000, 5.0F);
    for (int i = 0; i < scans; ++i) {
      ASSERT_TRUE(writer->imu({1e9 + 0.01 * i, {0, 0, 0}, {0, 0, 9.81}}));
      ASSERT_TRUE(writer->scan(1e9 + 0.01 * i, {1000, -1.5, 0.003, 1e-6, 0.01, 0.1, 40}, ranges, {}));
    }
    ASSERT_TRUE(writer->close());
  }
  ASSERT_GT(std::filesystem::file_size(large.path()), 80'000'000U);
  SensorSink sink;
  ASSERT_TRUE(read_log(small.path(), lidar_rig(), sink));
  const double before_mib = peak_memory_mib();
  ASSERT_TRUE(read_log(large.path(), lidar_rig(), sink));
  EXPECT_LT(peak_memory_mib() - before_mib, 2.0);
}

TEST(SensorLog, StopsWhenAskedTo) {
  struct Stop : Progress {
    bool cancelled() const override { return true; }
  } stop;
  LogOptions options;
  options.progress = &stop;
  std::string records = connections();
  for (unsigned i = 0; i < 8000; ++i) records += message(0, i, 0, imu(i, 0));  // over 1 MiB
  Collected got;
  const auto report = read(records, lidar_rig(), got, options);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::interrupted);
}

TEST(SensorLog, RefusesOptionsOutOfRange) {
  Collected got;
  LogOptions options;
  options.segment = -1;
  EXPECT_EQ(read("", lidar_rig(), got, options).error().code, ErrorCode::usage);
  options = {};
  options.reorder_window_s = kNaN;
  EXPECT_EQ(read("", lidar_rig(), got, options).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::formats
