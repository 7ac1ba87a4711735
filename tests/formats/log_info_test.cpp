#include "rayfield/formats/log_info.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rayfield/formats/rig_file.h"
#include "tests/formats/bag_bytes.h"

namespace rayfield::formats {
namespace {

using namespace bytes;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

struct Drive {
  const char* lidar_topic = "/horizontal/scan";
  bool spinner = true;
  double no_return = kInfinity;
  double gravity = 9.81;
  int gap_at = -1;      ///< second without IMU
  int jump_at = -1;     ///< second from which all stamps are an hour later
  int still_from = -1;  ///< second from which the spinner stands still for three seconds
  double rate = 0.1;    ///< of the gyroscope
};

/// 20 s: IMU at 50 Hz, scans at 5 Hz with a third of the beams without a return, GPS and joints at 5 Hz.
std::string drive_bag(const Drive& drive) {
  std::string records = connection(0, "/imu", kImuType, kImuMd5) + connection(1, "/fix", kFixType, kFixMd5) +
                        connection(2, "/joints", kJointType, kJointMd5) +
                        connection(3, drive.lidar_topic, kScanType, kScanMd5) +
                        connection(4, "/camera", "sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743");
  double angle = 0;
  for (int i = 0; i < 1000; ++i) {
    const bool jumped = drive.jump_at >= 0 && i / 50 >= drive.jump_at;
    const auto s = static_cast<std::uint32_t>(1000 + i / 50 + (jumped ? 3600 : 0));
    const auto ns = static_cast<std::uint32_t>(i % 50 * 20'000'000);
    if (i / 50 != drive.gap_at) records += message(0, s, ns, imu(s, ns, drive.rate, drive.gravity));
    if (i % 10 != 0) continue;
    if (drive.still_from < 0 || i < 50 * drive.still_from || i >= 50 * (drive.still_from + 3)) angle += 1.0;
    records += message(3, s, ns, scan(s, ns, {-1, 0.1, 1e-5, 0.05, 40}, {3.0, drive.no_return, 39.9}));
    records += message(1, s, ns, fix(s, ns, 0, -35.0 - 1e-5 * i, 138.5 + 1e-5 * i, 80 + 0.01 * i));
    records +=
        message(2, s, ns, joints(s, ns, {"wobble", "turntable"}, {0.001 * (i % 2), drive.spinner ? angle : 0.5}));
  }
  return bag_header() + chunk(records);
}

LogInfo inspect(const std::string& content) {
  const TemporaryFile file(content);
  const auto info = inspect_log(file.path());
  if (!info) ADD_FAILURE() << info.error().line();
  return info ? *info : LogInfo();
}

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

TEST(RigProposal, NamesTheTopicsAndWaitsForTheMounting) {
  const std::string text = propose_rig(inspect(drive_bag({})));
  EXPECT_THAT(text, HasSubstr("topic = \"/horizontal/scan\""));
  EXPECT_THAT(text, HasSubstr("joint = \"turntable\""));
  // As proposed it must not be usable: nobody knows yet how the sensors are mounted.
  const auto incomplete = parse_rig(text, "proposal");
  ASSERT_FALSE(incomplete);
  EXPECT_THAT(incomplete.error().line(), HasSubstr("extrinsics.imu_from_gps is missing"));
  std::string completed = text;
  for (std::size_t at = 0; (at = completed.find("# imu_from", at)) != std::string::npos;) completed.erase(at, 2);
  completed.erase(completed.find("# spinner_from_lidar"), 2);
  const auto rig = parse_rig(completed, "proposal");
  ASSERT_TRUE(rig) << rig.error().line();
  EXPECT_EQ(rig->lidar.topic, "/horizontal/scan");
  EXPECT_EQ(rig->lidar.max_range_m, 40.0);
  EXPECT_NEAR(rig->lidar.min_range_m, 0.05, 1e-6);
  EXPECT_EQ(rig->imu.topic, "/imu");
  EXPECT_EQ(rig->gps->topic, "/fix");
  EXPECT_EQ(rig->spinner->topic, "/joints");
}

TEST(RigProposal, SeesTheConventionForNoReturns) {
  for (const auto& [value, convention] :
       {std::pair(static_cast<double>(INFINITY), "inf"), std::pair(0.0, "zero"), std::pair(40.0, "max")}) {
    Drive drive;
    drive.no_return = value;
    EXPECT_THAT(propose_rig(inspect(drive_bag(drive))), HasSubstr(std::string("no_return = \"") + convention + "\""));
  }
}

TEST(RigProposal, ProposesAFixedLidarWhereNothingTurns) {
  Drive drive;
  drive.spinner = false;
  const std::string text = propose_rig(inspect(drive_bag(drive)));
  EXPECT_THAT(text, Not(HasSubstr("[spinner]")));
  EXPECT_THAT(text, HasSubstr("imu_from_lidar"));
}

TEST(RigProposal, QuotesWhateverATopicIsCalled) {
  Drive drive;
  drive.lidar_topic = "/a\"\n[imu]\\";
  EXPECT_THAT(propose_rig(inspect(drive_bag(drive))), HasSubstr(R"(topic = "/a\"\u000a[imu]\\")"));
}

}  // namespace
}  // namespace rayfield::formats
