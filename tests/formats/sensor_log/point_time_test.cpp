#include "formats/sensor_log/point_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/formats/sensor_log_support.h"

namespace rayfield::formats {
namespace {

using ::testing::HasSubstr;

struct Vendor {
  const char* name;
  std::vector<CloudField> fields;
  std::uint32_t step;
  std::string (*time)(double offset_s);
};

/// Each vendor's point: x y z as float32 at 0, the time at 16 or where it says.
TEST(PointTime, UnderstandsThePointTimesOfTheUsualDrivers) {
  const double stamp_s = 1549843200.5;
  const std::vector<CloudField> xyz = {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}};
  const auto with = [&](const CloudField& time_field) {
    std::vector<CloudField> fields = xyz;
    fields.push_back(time_field);
    return fields;
  };
  const std::vector<Vendor> vendors = {
      {"Velodyne time float32 s", with({"time", 16, 7}), 24, [](double s) { return f32(s) + u32(0); }},
      {"Ouster t uint32 ns", with({"t", 16, 6}), 24, [](double s) { return u32(std::llround(s * 1e9)) + u32(0); }},
      {"Hesai timestamp float64 s", with({"timestamp", 16, 8}), 24, [](double s) { return f64(1549843200.5 + s); }},
      {"Livox timestamp float64 ns", with({"timestamp", 16, 8}), 24,
       [](double s) { return f64((1549843200.5 + s) * 1e9); }},
      {"Livox offset_time uint32 ns", with({"offset_time", 16, 6}), 24,
       [](double s) { return u32(std::llround(s * 1e9)) + u32(0); }},
      {"timestamp float64 µs", with({"timestamp", 16, 8}), 24, [](double s) { return f64((1549843200.5 + s) * 1e6); }},
  };
  for (const Vendor& vendor : vendors) {
    std::string data;
    for (int i = 0; i < 3; ++i) {
      data += f32(3) + f32(4) + f32(0) + u32(0) + vendor.time(0.03 * i);
    }
    Collected got;
    const auto report = read(connections(kCloudType, kCloudMd5) +
                                 message(3, 1, 0, cloud(1549843200, 500000000, vendor.fields, vendor.step, data)),
                             lidar_rig(), got, any_sensors());
    ASSERT_TRUE(report) << vendor.name << ": " << report.error().line();
    ASSERT_EQ(got.scans.size(), 1U) << vendor.name;
    EXPECT_EQ(got.scans[0].time_s, stamp_s);
    for (std::size_t i = 0; i < 3; ++i) {
      // Doubles of seconds since 1970 have 0.24 µs spacing.
      EXPECT_NEAR(got.scans[0].time_offset_s[i], 0.03 * static_cast<double>(i), 3e-7) << vendor.name;
      EXPECT_EQ(got.scans[0].range_m[i], 5.0F);
      EXPECT_NEAR(got.scans[0].direction[i].y(), 0.8, 1e-7);
    }
  }
}

TEST(PointTime, RefusesPointCloudsWithoutTimePerPoint) {
  Collected got;
  const std::string data = f32(3) + f32(4) + f32(0) + f32(1);
  const auto report =
      read(connections(kCloudType, kCloudMd5) +
               message(3, 1, 0, cloud(1, 0, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"intensity", 12, 7}}, 16, data)),
           lidar_rig(), got, any_sensors());
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::bad_input);
  EXPECT_THAT(report.error().line(), HasSubstr("no time per point (fields: x y z intensity)"));
}

}  // namespace
}  // namespace rayfield::formats
