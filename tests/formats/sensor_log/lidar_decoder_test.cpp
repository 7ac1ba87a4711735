#include "formats/sensor_log/lidar_decoder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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
