#include "rayfield/formats/rig_proposal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rayfield/formats/rig_file.h"
#include "tests/formats/drive_bag.h"

namespace rayfield::formats {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

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

TEST(RigProposal, AsksWhichLidarItIsAndWhichEchoItReports) {
  std::string text = propose_rig(inspect(drive_bag({})));
  for (std::size_t at = 0; (at = text.find("# imu_from", at)) != std::string::npos;) text.erase(at, 2);
  for (const char* line : {"# spinner_from_lidar", "# model = \"", "# returns = \""}) {
    ASSERT_NE(text.find(line), std::string::npos) << line << "\n" << text;
    text.erase(text.find(line), 2);
  }
  const auto rig = parse_rig(text, "proposal");
  ASSERT_TRUE(rig) << rig.error().line();
  ASSERT_TRUE(rig->lidar.beam);
  EXPECT_EQ(rig->lidar.beam->returns, ReturnMode::first);
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
