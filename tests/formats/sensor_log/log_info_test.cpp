#include "rayfield/formats/log_info.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/formats/drive_bag.h"

namespace rayfield::formats {
namespace {

using namespace bytes;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const TopicInfo& topic(const LogInfo& info, const std::string& name) {
  for (const TopicInfo& each : info.topics) {
    if (each.topic == name) return each;
  }
  throw std::runtime_error("no topic " + name);
}

TEST(LogInfo, ListsTopicsRatesAndExtents) {
  const LogInfo info = inspect(drive_bag({}));
  EXPECT_EQ(info.topics.size(), 5U);
  EXPECT_EQ(topic(info, "/imu").messages, 1000U);
  EXPECT_NEAR(topic(info, "/imu").rate_hz, 50, 1e-6);
  EXPECT_NEAR(topic(info, "/fix").rate_hz, 5, 1e-6);
  EXPECT_EQ(topic(info, "/camera").messages, 0U);
  EXPECT_EQ(topic(info, "/imu").frame_id, "f");
  EXPECT_NEAR(info.duration_s, 19.98, 1e-9);
  EXPECT_EQ(topic(info, "/imu").gaps, 0U);
  ASSERT_EQ(info.gps.size(), 1U);
  EXPECT_NEAR(info.gps[0].south_deg, -35.0 - 990e-5, 1e-12);
  EXPECT_NEAR(info.gps[0].north_deg, -35.0, 1e-12);
  EXPECT_NEAR(info.gps[0].highest_m, 89.9, 1e-9);
  ASSERT_EQ(info.lidars.size(), 1U);
  EXPECT_EQ(info.lidars[0].points, 300U);
  EXPECT_EQ(info.lidars[0].infinite, 100U);
  EXPECT_NEAR(info.lidars[0].largest_m, 39.9, 1e-5);
  EXPECT_NEAR(info.imus.at(0).mean_acceleration_m_s2, std::sqrt(0.4 * 0.4 + 0.5 * 0.5 + 9.81 * 9.81), 1e-9);
}

TEST(LogInfo, FindsGapsAndUnitsThatAreWrong) {
  Drive drive;
  drive.gap_at = 10;
  const LogInfo gap = inspect(drive_bag(drive));
  EXPECT_EQ(topic(gap, "/imu").gaps, 1U);
  EXPECT_NEAR(topic(gap, "/imu").longest_gap_s, 1.02, 1e-9);
  EXPECT_THAT(gap.problems(), Contains(HasSubstr("/imu: 1 gaps, the longest 1.020 s")));
  drive = {};
  drive.gravity = 0.6;
  EXPECT_THAT(inspect(drive_bag(drive)).problems(), Contains(HasSubstr("not the 9.8 m/s2 of gravity")));
}

TEST(LogInfo, TellsAClockJumpFromAGap) {
  Drive drive;
  drive.jump_at = 12;
  const LogInfo info = inspect(drive_bag(drive));
  EXPECT_EQ(topic(info, "/imu").clock_jumps, 1U);
  EXPECT_EQ(topic(info, "/imu").gaps, 0U);
  EXPECT_LT(topic(info, "/imu").longest_gap_s, 0.1);
  EXPECT_THAT(info.problems(), Contains("/imu: its clock jumps once"));
  EXPECT_THAT(info.problems(), Contains("the recording's clock jumps once"));
}

TEST(LogInfo, SeesASpinnerThatStopsOrNeverTurnsAndAGyroscopeInDegrees) {
  EXPECT_THAT(inspect(drive_bag({})).problems(), ElementsAre(HasSubstr("no index"))) << "the drive itself is sound";
  Drive drive;
  drive.still_from = 5;
  EXPECT_THAT(inspect(drive_bag(drive)).problems(), Contains("/joints: joint 'turntable' stands still for 3.0 s"));
  drive = {};
  drive.spinner = false;
  EXPECT_THAT(inspect(drive_bag(drive)).problems(), Contains(HasSubstr("no joint goes round")));
  drive = {};
  drive.rate = 60;
  EXPECT_THAT(inspect(drive_bag(drive)).problems(), Contains(HasSubstr("as if the gyroscope were in degrees")));
}

TEST(LogInfo, NamesWhatIsMissing) {
  const LogInfo info = inspect(bag_header());
  EXPECT_THAT(info.problems(), Contains(HasSubstr("no messages")));
  EXPECT_THAT(info.problems(), Contains(HasSubstr("no lidar")));
  EXPECT_THAT(info.problems(), Contains(HasSubstr("no IMU")));
  EXPECT_THAT(info.problems(), Contains(HasSubstr("no GPS")));
}

}  // namespace
}  // namespace rayfield::formats
