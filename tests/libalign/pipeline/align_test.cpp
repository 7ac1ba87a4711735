#include "rayfield/align/align.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/libalign/synthetic_block.h"

namespace rayfield::align {
namespace {

using testing::HasSubstr;

TEST(Align, LaysADriveOnItsReferenceToAFewMillimetres) {
  const SyntheticBlock block;
  SyntheticDrive drive;
  std::mt19937 random(5);
  drive.error = random_error(block, random);
  drive.seed = 2;
  drive.grass_m = 0.05;
  const auto found = align_landmarks(drive_along(block, {}), drive_along(block, drive), {}, "scan");
  ASSERT_TRUE(found) << found.error().why;
  const Miss miss = miss_of(block, drive, *found);
  // Three standard errors of a mean of some 60 pairs with 1.4 cm of noise per axis; the end is a turn away.
  EXPECT_LT(miss.middle_m, 0.008);
  EXPECT_LT(miss.end_m, 0.016);
  EXPECT_NEAR(found->shift.shift.z(), -drive.error.shift.z() - drive.grass_m, 0.01);
  EXPECT_GT(found->landmarks, 50);
  EXPECT_LT(found->residual_rms_m, 0.025);
  EXPECT_FALSE(found->rivals.empty());
}

TEST(Align, RefusesWhatFitsTwoPlacesAlike) {
  // Trunks alike and in line, none missing, level ground, and a drive that saw no end of a row.
  SyntheticBlock block;
  block.length_m = 42;  // seven panels of four vines
  block.missing = 0, block.across_jitter_m = 0, block.radius_spread = 0, block.slope = 0, block.relief_m = 0;
  SyntheticDrive drive;
  drive.from_m = 8, drive.to_m = 28;
  drive.seed = 2;
  const auto found = align_landmarks(drive_along(block, {}), drive_along(block, drive), {}, "scan");
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::bad_input);
  EXPECT_THAT(found.error().why, HasSubstr("two places fit alike"));
  EXPECT_THAT(found.error().why, HasSubstr("away (log-likelihood")) << "and it says where the other place is";
}

TEST(Align, RefusesAnotherBlock) {
  const SyntheticBlock block;
  std::vector<SyntheticBlock> others(5);
  others[0].spacing_m = 2.2;
  others[1].vine_m = 1.2, others[1].panel_m = 7;
  others[2].azimuth_rad = 0.9;
  others[3].middle.x() += 80000;
  others[4].seed = 99, others[4].relief_m = 0.8;  // planted alike on other ground
  for (std::size_t i = 0; i < others.size(); ++i) {
    SyntheticDrive drive;
    drive.seed = 2;
    const auto found = align_landmarks(drive_along(block, {}), drive_along(others[i], drive), {}, "scan");
    ASSERT_FALSE(found) << i;
    EXPECT_EQ(found.error().code, ErrorCode::bad_input) << i;
  }
}

TEST(Align, TakesADriveForTheBlockTurnedByHalfATurnOnlyIfItIs) {
  SyntheticBlock block;
  block.slope = 0.06;
  SyntheticDrive drive;
  drive.error.pivot = block.middle, drive.error.yaw_rad = std::numbers::pi;
  drive.seed = 2;
  const auto found = align_landmarks(drive_along(block, {}), drive_along(block, drive), {}, "scan");
  ASSERT_TRUE(found) << found.error().why;
  EXPECT_LT(miss_of(block, drive, *found).end_m, 0.02);
}

TEST(Align, BendsADriveThatDriftedAndOnlyThat) {
  SyntheticBlock block;
  block.length_m = 198;
  SyntheticDrive straight, bent;
  straight.seed = 2, bent.seed = 2;
  bent.bend_m = 0.06, bent.bend_length_m = 150;
  const BlockLandmarks reference = drive_along(block, {});
  const auto rigid = align_landmarks(reference, drive_along(block, straight), {}, "scan");
  const auto warped = align_landmarks(reference, drive_along(block, bent), {}, "scan");
  ASSERT_TRUE(rigid && warped);
  EXPECT_TRUE(rigid->warp.empty());
  ASSERT_FALSE(warped->warp.empty());
  EXPECT_LT(warped->residual_rms_m, 0.025);
  EXPECT_GT(warped->warp_rms_m, 0.02);
}

TEST(Align, LaysADriveOnASurveyOfPosts) {
  const SyntheticBlock block;
  BlockLandmarks survey = drive_along(block, {});
  std::erase_if(survey.uprights, [](const Upright& upright) { return !upright.post; });
  survey.ground = {};
  SyntheticDrive drive;
  std::mt19937 random(8);
  drive.error = random_error(block, random);
  drive.seed = 2;
  const auto found = align_landmarks(survey, drive_along(block, drive), {}, "scan");
  ASSERT_TRUE(found) << found.error().why;
  EXPECT_LT(miss_of(block, drive, *found).middle_m, 0.02);
  EXPECT_EQ(found->shift.shift.z(), 0);
}

TEST(Align, NeedsLandmarks) {
  const SyntheticBlock block;
  BlockLandmarks few = drive_along(block, {});
  few.uprights.resize(3);
  const auto found = align_landmarks(drive_along(block, {}), few, {}, "scan.ply");
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().where, "scan.ply");
  EXPECT_THAT(found.error().why, HasSubstr("3 posts and trunks"));
}

}  // namespace
}  // namespace rayfield::align
