#include "rayfield/formats/sensor_log_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>

#include "rayfield/formats/rosbag_reader.h"
#include "rayfield/formats/sensor_log.h"
#include "tests/formats/bag_bytes.h"

namespace rayfield::formats {
namespace {

using namespace bytes;

/// Collects what a log delivers.
struct Collected : SensorSink {
  std::vector<ImuSample> imus;
  std::vector<GpsFix> fixes;
  std::vector<SpinnerAngle> angles;
  std::vector<LidarScan> scans;
  void imu(const ImuSample& sample) override { imus.push_back(sample); }
  void gps(const GpsFix& fix) override { fixes.push_back(fix); }
  void spinner(const SpinnerAngle& angle) override { angles.push_back(angle); }
  void lidar(const LidarScan& scan) override { scans.push_back(scan); }
};

Rig spinning_rig() {
  Rig rig;
  rig.spinner = Rig::Spinner();
  rig.gps = Rig::Gps();
  return rig;
}

ScanPattern five_beams() { return {5, -0.2, 0.1, 2e-5, 0.01, 0.1, 40.0}; }

void write_log(const std::string& path, const Rig& rig, bool points, const BagWriteOptions& options = {}) {
  auto writer = SensorLogWriter::create(path, rig, options);
  ASSERT_TRUE(writer) << writer.error().line();
  const float inf = INFINITY;
  for (int i = 0; i < 50; ++i) {
    const double t = 1549843200.01 + 0.01 * i;
    ASSERT_TRUE(writer->imu({t, {0.01 * i, -1, 2}, {0.5, 0.25, 9.81}}));
    ASSERT_TRUE(writer->spinner({t, 0.03 * i}, 3.0));
    const std::vector<float> ranges = {5.0F, inf, 0.05F, 12.5F + static_cast<float>(i), NAN};
    if (!points) {
      ASSERT_TRUE(writer->scan(t, five_beams(), ranges, std::vector<float>{1, 2, 3, 4, 5}));
    } else {
      LidarScan scan;
      scan.time_s = t;
      scan.range_m = ranges;
      scan.direction = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6F, 0, 0.8F}, {0, -1, 0}};
      scan.time_offset_s = {0, 1e-3F, 2e-3F, 3e-3F, 4e-3F};
      scan.intensity = {1, 2, 3, 4, 5};
      ASSERT_TRUE(writer->points(scan, std::vector<std::uint16_t>{0, 1, 2, 3, 4}));
    }
    if (i % 10 == 0) {
      GpsFix fix{t, -35.2186, 138.5411, 82.5, Eigen::Matrix3d::Identity() * 0.49, 1, 2};
      ASSERT_TRUE(writer->gps(fix));
    }
  }
  const auto closed = writer->close();
  ASSERT_TRUE(closed) << closed.error().line();
}

TEST(SensorLogWriter, RoundTripsTheSensorsOfASpinningRig) {
  const TemporaryFile file("");
  write_log(file.path(), spinning_rig(), false);
  Collected got;
  const auto report = read_log(file.path(), spinning_rig(), got);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_THAT(report->warnings(), ::testing::ElementsAre(::testing::HasSubstr("20.0 % of the lidar's points are NaN")));
  ASSERT_EQ(got.imus.size(), 50U);
  ASSERT_EQ(got.scans.size(), 50U);
  ASSERT_EQ(got.angles.size(), 50U);
  ASSERT_EQ(got.fixes.size(), 5U);
  EXPECT_EQ(got.imus[7].time_s, 1549843200.01 + 0.01 * 7);
  EXPECT_EQ(got.imus[7].angular_velocity_rad_s, Eigen::Vector3d(0.01 * 7, -1, 2));
  EXPECT_EQ(got.imus[7].linear_acceleration_m_s2, Eigen::Vector3d(0.5, 0.25, 9.81));
  EXPECT_EQ(got.angles[49].angle_rad, 0.03 * 49);
  EXPECT_EQ(got.fixes[4].latitude_deg, -35.2186);
  EXPECT_EQ(got.fixes[4].covariance_enu_m2(2, 2), 0.49);
  EXPECT_EQ(got.fixes[4].status, 1);
  const LidarScan& scan = got.scans[3];
  EXPECT_EQ(scan.range_m[0], 5.0F);
  EXPECT_EQ(scan.range_m[1], INFINITY);
  EXPECT_EQ(scan.range_m[2], -INFINITY);  // 0.05 m is below min_range_m
  EXPECT_EQ(scan.range_m[3], 15.5F);
  EXPECT_TRUE(std::isnan(scan.range_m[4]));
  EXPECT_NEAR(scan.time_offset_s[4], 8e-5, 1e-11);
  EXPECT_NEAR(scan.direction[4].x(), std::cos(0.2), 1e-7);
  EXPECT_NEAR(scan.direction[4].y(), std::sin(0.2), 1e-7);
  EXPECT_EQ(scan.direction[4].z(), 0.0F);
  EXPECT_EQ(scan.intensity[4], 5.0F);
}

TEST(SensorLogWriter, KeepsRaysWithoutAReturnInEveryConventionOfAScan) {
  for (const NoReturn convention : {NoReturn::infinity, NoReturn::zero, NoReturn::max_range}) {
    Rig rig = spinning_rig();
    rig.lidar.no_return = convention;
    const TemporaryFile file("");
    write_log(file.path(), rig, false);
    Collected got;
    const auto report = read_log(file.path(), rig, got);
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_EQ(report->points.no_returns, 50U + 22U);  // one a scan, and 12.5 + i is above 40 m from i = 28 on
    EXPECT_EQ(report->points.too_close, 50U);
    EXPECT_EQ(report->points.invalid, 50U);
    EXPECT_EQ(report->points.returns, 100U - 22U);
  }
}

TEST(SensorLogWriter, RoundTripsPointCloudsWithTimePerPoint) {
  Rig rig = spinning_rig();
  rig.lidar.no_return = NoReturn::max_range;
  const TemporaryFile file("");
  write_log(file.path(), rig, true);
  Collected got;
  const auto report = read_log(file.path(), rig, got);
  ASSERT_TRUE(report) << report.error().line();
  ASSERT_EQ(got.scans.size(), 50U);
  const LidarScan& scan = got.scans[2];
  ASSERT_EQ(scan.range_m.size(), 4U);  // the NaN has no direction and is left out
  EXPECT_EQ(scan.range_m[1], INFINITY);
  EXPECT_NEAR((scan.direction[1] - Eigen::Vector3f(0, 1, 0)).norm(), 0, 1e-7);
  EXPECT_EQ(scan.range_m[2], -INFINITY);
  EXPECT_NEAR(scan.range_m[3], 14.5, 1e-5);
  EXPECT_NEAR((scan.direction[3] - Eigen::Vector3f(0.6F, 0, 0.8F)).norm(), 0, 1e-6);
  EXPECT_EQ(scan.time_offset_s[3], 3e-3F);
  EXPECT_EQ(scan.intensity[3], 4.0F);
  EXPECT_EQ(report->points.invalid, 50U);
}

// A sweep of 16 beams whose upper half sees the sky in part.
TEST(SensorLogWriter, PointCloudsWithRingsKeepRaysWithoutAReturnUnderEveryConvention) {
  LidarScan sweep;
  std::vector<std::uint16_t> rings;
  for (int k = 0; k < 16 * 360; ++k) {
    const int ring = k % 16, step = k / 16;
    const double elevation = (-15 + 2.0 * ring) * M_PI / 180, azimuth = step * M_PI / 180;
    sweep.direction.push_back(Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation))
                                  .cast<float>());
    sweep.range_m.push_back(ring > 8 && (step + ring) % 3 == 0 ? INFINITY : 4.0F);
    sweep.time_offset_s.push_back(0.1F * static_cast<float>(step) / 360.0F);
    rings.push_back(static_cast<std::uint16_t>(ring));
  }
  for (const NoReturn convention : {NoReturn::infinity, NoReturn::zero, NoReturn::max_range}) {
    Rig rig;
    rig.lidar.no_return = convention;
    const TemporaryFile file("");
    auto writer = SensorLogWriter::create(file.path(), rig);
    ASSERT_TRUE(writer);
    for (int n = 0; n < 3; ++n) {
      sweep.time_s = 100 + 0.1 * n;
      ASSERT_TRUE(writer->points(sweep, rings));
    }
    ASSERT_TRUE(writer->close());
    Collected got;
    const auto report = read_log(file.path(), rig, got, LogOptions{.require_imu = false});
    ASSERT_TRUE(report) << report.error().line();
    ASSERT_EQ(got.scans.size(), 3U);
    EXPECT_EQ(report->points.points, 3U * 16 * 360);
    EXPECT_EQ(report->points.no_returns, 3U * 7 * 120);
    EXPECT_EQ(report->points.restored, convention == NoReturn::max_range ? 0U : 3U * 7 * 120);
    for (const LidarScan& scan : got.scans) {
      ASSERT_EQ(scan.range_m.size(), sweep.range_m.size());
      for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
        EXPECT_EQ(std::isinf(scan.range_m[i]), std::isinf(sweep.range_m[i]));
        EXPECT_LT((scan.direction[i] - sweep.direction[i]).norm(), 1e-3F);
      }
    }
  }
}

// Of both kinds of message; what is read are the first echoes.
TEST(SensorLogWriter, WritesSeveralEchoesOfABeam) {
  LidarScan scan;
  scan.time_s = 100;
  scan.range_m = {5, INFINITY, 7, 9};
  scan.intensity = {50, 0, 70, 90};
  scan.later = {{0, 6, 60}, {0, 8, 80}, {3, 12, 20}};
  for (const float angle : {-0.2F, -0.1F, 0.0F, 0.1F}) scan.direction.push_back({std::cos(angle), std::sin(angle), 0});
  scan.time_offset_s = {0, 1e-3F, 2e-3F, 3e-3F};
  for (const bool points : {false, true}) {
    const TemporaryFile file("");
    auto writer = SensorLogWriter::create(file.path(), Rig());
    ASSERT_TRUE(writer);
    ASSERT_TRUE(points ? writer->points(scan, std::vector<std::uint16_t>{0, 1, 2, 3})
                       : writer->multi_echo_scan({4, -0.2, 0.1, 1e-3, 0.01, 0.1, 40}, scan));
    ASSERT_TRUE(writer->close());
    Collected got;
    const auto report = read_log(file.path(), Rig(), got, LogOptions{.require_imu = false});
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_EQ(report->points.later_echoes, 3U);
    const LidarScan& read = got.scans.at(0);
    const bool has_empty = !points;  // too few points to tell where a gap of a cloud points
    ASSERT_EQ(read.range_m.size(), has_empty ? 4U : 3U);
    EXPECT_NEAR(read.range_m[0], 5, 1e-6);
    EXPECT_EQ(read.intensity[0], 50);
    EXPECT_EQ(read.range_m[1], has_empty ? INFINITY : 7.0F);
    EXPECT_NEAR(read.range_m.back(), 9, 1e-6);
    EXPECT_EQ(read.intensity.back(), 90);
    EXPECT_NEAR((read.direction.back() - scan.direction.back()).norm(), 0, 1e-6);
  }
}

TEST(SensorLogWriter, RefusesLaterEchoesThatFollowNoReturnOrAreOutOfOrder) {
  const TemporaryFile file("");
  auto writer = SensorLogWriter::create(file.path(), Rig());
  LidarScan scan;
  scan.range_m = {5, INFINITY, 7}, scan.time_offset_s = {0, 0, 0};
  scan.direction.assign(3, Eigen::Vector3f::UnitX());
  using Later = std::vector<LaterEcho>;
  for (const Later& later : {Later{{3, 8, 1}}, Later{{1, 8, 1}}, Later{{2, 8, 1}, {0, 6, 1}}}) {
    scan.later = later;
    EXPECT_EQ(writer->points(scan, {}).error().code, ErrorCode::usage);
    EXPECT_EQ(writer->multi_echo_scan({3, -0.1, 0.1, 1e-3, 0.01, 0.1, 40}, scan).error().code, ErrorCode::usage);
  }
  EXPECT_EQ(writer->multi_echo_scan(five_beams(), scan).error().code, ErrorCode::usage);
}

TEST(SensorLogWriter, RefusesColumnsOfUnequalLengthAndSensorsThatTheRigLacks) {
  const TemporaryFile file("");
  auto writer = SensorLogWriter::create(file.path(), Rig());
  EXPECT_EQ(writer->gps({}).error().code, ErrorCode::usage);
  EXPECT_EQ(writer->spinner({}, 0).error().code, ErrorCode::usage);
  EXPECT_EQ(writer->scan(1, five_beams(), std::vector<float>(4), {}).error().code, ErrorCode::usage);
  LidarScan scan;
  scan.range_m.resize(3);
  EXPECT_EQ(writer->points(scan, {}).error().code, ErrorCode::usage);
  EXPECT_EQ(writer->imu({kNaN, {}, {}}).error().code, ErrorCode::usage);
  EXPECT_EQ(writer->imu({1e300, {}, {}}).error().code, ErrorCode::usage);
}

/// Runs the ROS tools' own reader over a bag; -1 where they are not installed.
int run_rosbag(const std::string& script, const std::string& path) {
  if (std::system("/usr/bin/python3 -c 'import rosbag, sensor_msgs.msg' > /dev/null 2>&1") != 0) return -1;
  const TemporaryFile program(script, ".py");
  const int status = std::system(("/usr/bin/python3 " + program.path() + " " + path).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

TEST(SensorLogWriter, WritesBagsThatTheRosToolsRead) {
  // Checks md5sums against those of the installed sensor_msgs and reads by the index, which needs chunk infos,
  // index records and the definitions in the connections to be right.
  const std::string script = R"(
import sys, rosbag
from sensor_msgs.msg import Imu, LaserScan, PointCloud2, NavSatFix, JointState
types = {c._type: c for c in (Imu, LaserScan, PointCloud2, NavSatFix, JointState)}
with rosbag.Bag(sys.argv[1]) as bag:
    info = bag.get_type_and_topic_info()
    for type_name, md5 in info.msg_types.items():
        assert types[type_name]._md5sum == md5, type_name
    counts = {}
    last = None
    for topic, message, stamp in bag.read_messages():
        counts[topic] = counts.get(topic, 0) + 1
        assert last is None or stamp >= last
        last = stamp
        assert message.header.stamp == stamp
        if topic == '/imu/data':
            assert message.linear_acceleration.z == 9.81
            assert message.orientation_covariance[0] == -1
        if topic == '/spinner/joint_states':
            assert message.name == ['spinner'] and message.velocity[0] == 3.0
        if topic == '/gps/fix':
            assert message.latitude == -35.2186 and message.position_covariance_type == 2
        if topic == '/lidar/scan' and message._type == 'sensor_msgs/LaserScan':
            assert len(message.ranges) == 5 and abs(message.angle_max - 0.2) < 1e-6
        if topic == '/lidar/scan' and message._type == 'sensor_msgs/PointCloud2':
            assert message.width == 5 and len(message.data) == 5 * message.point_step
            assert [f.name for f in message.fields] == ['x', 'y', 'z', 'intensity', 'ring', 'time']
    assert counts == {'/imu/data': 50, '/spinner/joint_states': 50, '/lidar/scan': 50, '/gps/fix': 5}, counts
    part = list(bag.read_messages(topics=['/gps/fix'],
                                  start_time=rosbag.bag.genpy.Time.from_sec(1549843200.2)))
    assert len(part) == 3, len(part)
)";
  for (const bool points : {false, true}) {
    for (const BagCompression compression : {BagCompression::none, BagCompression::bz2, BagCompression::lz4}) {
      const TemporaryFile file("");
      BagWriteOptions options;
      options.compression = compression;
      options.chunk_bytes = 4096;
      write_log(file.path(), spinning_rig(), points, options);
      const int status = run_rosbag(script, file.path());
      if (status == -1) GTEST_SKIP() << "python3-rosbag and python3-sensor-msgs are not installed";
      EXPECT_EQ(status, 0) << "compression " << static_cast<int>(compression) << ", points " << points;
    }
  }
}

}  // namespace
}  // namespace rayfield::formats
