#include "formats/sensor_log/lidar_decoder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "tests/formats/sensor_log_support.h"

namespace rayfield::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(LidarDecoder, FollowsRep117AndTheLimitsOfTheRig) {
  // Columns: the raw ranges; what each convention makes of them. inf: nothing; -inf: too close; n: NaN.
  const double inf = kInfinity;
  const std::vector<double> raw = {5.0, inf, -inf, kNaN, 0.0, 0.1, 30.0, 35.0, -2.0};
  const auto classify = [&](NoReturn convention) {
    Rig rig = lidar_rig();
    rig.lidar.max_range_m = 30;
    rig.lidar.no_return = convention;
    Collected got;
    const auto report = read(connections() + message(3, 1, 0, scan(1, 0, {}, raw)), rig, got, any_sensors());
    EXPECT_TRUE(report) << report.error().line();
    std::string text;
    for (const float range : got.scans.at(0).range_m) {
      text += std::isnan(range) ? "n" : range == INFINITY ? "+" : range == -INFINITY ? "-" : "r";
    }
    EXPECT_EQ(report->points.points, report->points.returns + report->points.no_returns + report->points.too_close +
                                         report->points.invalid + report->points.without_direction);
    return text;
  };
  EXPECT_EQ(classify(NoReturn::infinity), "r+-n--r+n");
  EXPECT_EQ(classify(NoReturn::zero), "r+-n+-r+n");
  EXPECT_EQ(classify(NoReturn::max_range), "r+-n--++n");
}

TEST(LidarDecoder, RefusesAMaximumRangeAboveTheSensors) {
  Collected got;
  ScanNumbers numbers;
  numbers.range_max = 25;
  const auto report =
      read(connections() + message(3, 1, 0, scan(1, 0, numbers, {1.0})), lidar_rig(), got, any_sensors());
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::usage);
  EXPECT_THAT(report.error().line(), HasSubstr("set max_range_m = 25"));
}

Result<LogReport> read_echoes(const std::string& data, Collected& got, NoReturn no_return = NoReturn::infinity) {
  Rig rig = lidar_rig();
  rig.lidar.max_range_m = 30, rig.lidar.no_return = no_return;
  return read(connections(kMultiEchoType, kMultiEchoMd5) + message(3, 1, 0, data), rig, got, any_sensors());
}

TEST(LidarDecoder, TakesTheFirstOfSeveralEchoes) {
  const ScanNumbers numbers{-1, 0.1, 1e-5, 0.1, 40};
  const Echoes ranges = {{4, 7}, {}, {9, 3, 35}, {0.1, 6}, {kNaN}, {0.1}};
  const Echoes strengths = {{40, 70}, {}, {90, 30, 35}, {1, 60}, {5}, {6}};
  Collected got;
  const auto report = read_echoes(multi_echo_scan(1, 0, numbers, ranges, strengths), got);
  ASSERT_TRUE(report) << report.error().line();
  const LidarScan& scan = got.scans.at(0);
  ASSERT_EQ(scan.range_m.size(), 6U);
  EXPECT_THAT(std::span(scan.range_m).first(4), ElementsAre(4.0F, INFINITY, 3.0F, 6.0F));
  EXPECT_TRUE(std::isnan(scan.range_m[4]));
  EXPECT_EQ(scan.range_m[5], -INFINITY);
  EXPECT_THAT(scan.intensity, ElementsAre(40, 0, 30, 60, 5, 6));
  EXPECT_NEAR(scan.direction[3].y(), std::sin(-0.7), 1e-6);
  EXPECT_NEAR(scan.time_offset_s[3], 3e-5, 1e-9);
  const LidarPointCounts& points = report->points;
  EXPECT_EQ(points.points, 6U);
  EXPECT_EQ(points.returns, 3U);
  EXPECT_EQ(points.no_returns, 1U);
  EXPECT_EQ(points.later_echoes, 2U);  // 7 and 9 m; 35 m is beyond the rig's limit
  EXPECT_THAT(report->warnings(), ::testing::Contains(HasSubstr("2 later ones are left out")));
}

TEST(LidarDecoder, IntensitiesOfSeveralEchoesAreAsManyAsThese) {
  for (const Echoes& strengths : {Echoes{}, Echoes{{1, 2}}, Echoes{{1, 2}, {3, 4}}}) {
    Collected got;
    ASSERT_TRUE(read_echoes(multi_echo_scan(1, 0, {}, {{4, 7}, {5}}, strengths), got));
    EXPECT_TRUE(got.scans.at(0).intensity.empty());
  }
}

TEST(LidarDecoder, NothingIsMetByABeamWithoutEchoesUnderAnyConvention) {
  for (const NoReturn convention : {NoReturn::infinity, NoReturn::zero, NoReturn::max_range}) {
    Collected got;
    ASSERT_TRUE(read_echoes(multi_echo_scan(1, 0, {}, {{}, {5}}), got, convention));
    EXPECT_THAT(got.scans.at(0).range_m, ElementsAre(INFINITY, 5.0F));
  }
}

TEST(LidarDecoder, LeavesOutScansOfSeveralEchoesWhoseLengthsDoNotFit) {
  const std::string whole = multi_echo_scan(1, 0, {}, {{4, 7}, {5}}, {{1, 2}, {3}});
  std::string wrong = whole;
  wrong[wrong.size() - 8] = 9;  // the last beam's count of intensities
  for (const std::string& data : {whole.substr(0, whole.size() - 1), whole + "x", wrong}) {
    Collected got;
    const auto report = read_echoes(data, got);
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_TRUE(got.scans.empty());
    EXPECT_EQ(report->topic(SensorKind::lidar).undecodable, 1U);
  }
}

TEST(LidarDecoder, TakesTheFirstEchoOfPointsThatShareRingAndTime) {
  std::string data;
  const auto add = [&](double x, double y, int ring, double time_s) {
    data += f32(x) + f32(y) + f32(0) + f32(10 * x) + le(static_cast<std::uint16_t>(ring)) + f32(time_s);
  };
  add(6, 0, 0, 0), add(0, 5, 1, 0), add(0, 9, 1, 1e-3), add(4, 0, 0, 0), add(0, 5, 1, 0), add(kNaN, 0, 1, 1e-3);
  Collected got;
  const auto report = read(
      connections(kCloudType, kCloudMd5) +
          message(3, 1, 0,
                  cloud(1, 0,
                        {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"intensity", 12, 7}, {"ring", 16, 4}, {"time", 18, 7}},
                        22, data)),
      lidar_rig(), got, any_sensors());
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_THAT(got.scans.at(0).range_m, ElementsAre(5.0F, 9.0F, 4.0F));
  EXPECT_THAT(got.scans.at(0).intensity, ElementsAre(0.0F, 0.0F, 40.0F));
  EXPECT_EQ(report->points.later_echoes, 1U);
  EXPECT_EQ(report->points.points, 3U);
}

TEST(LidarDecoder, LeavesOutPointsWhoseDirectionIsUnknown) {
  Collected got;
  std::string data;
  for (const double x : {0.0, 2.0, static_cast<double>(NAN)}) data += f32(x) + f32(0) + f32(0) + f32(0);
  const auto report =
      read(connections(kCloudType, kCloudMd5) +
               message(3, 1, 0, cloud(1, 0, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"time", 12, 7}}, 16, data)),
           lidar_rig(), got, any_sensors());
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_THAT(got.scans.at(0).range_m, ElementsAre(2.0F));
  EXPECT_EQ(report->points.without_direction, 1U);
  EXPECT_EQ(report->points.invalid, 1U);
  EXPECT_THAT(report->warnings(), ::testing::Contains(HasSubstr("at the sensor's origin")));
}

}  // namespace
}  // namespace rayfield::formats
