#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/libdensity/simulated_block.h"

namespace rayfield::density {
namespace {

using testing::Block;
using testing::drive_past;

sim::Site site_with(sim::LeafAngles angles) {
  sim::Site site = testing::block_site(1, 31);
  site.canopy.leaf_angles = angles;
  return site;
}

// Truth is of leaves and wood.
double ratio_of(const testing::Drive& drive, LeafAngleType type, std::string& notes) {
  Block block;
  block.add("2019-08-01", drive, false);
  ProcessOptions options;
  options.voxels.leaf_angles.type = type;
  const ProcessReport report = block.process({}, options);
  for (const std::string& note : report.scans.at(0).notes) notes += note + "\n";
  return report.scans[0].plant_area_m2 / (drive.leaf_area_m2 + drive.wood_area_m2);
}

TEST(LeafAnglesOfABlock, FlatLeavesAreSeenAndCountedAsSuch) {
  const testing::Drive drive = drive_past(site_with(sim::LeafAngles::planophile));
  std::string notes;
  EXPECT_LT(ratio_of(drive, LeafAngleType::spherical, notes), 0.82);
  EXPECT_EQ(notes.find("flatter"), std::string::npos) << notes;
  EXPECT_NEAR(ratio_of(drive, LeafAngleType::measured, notes), 1, 0.1);
  EXPECT_NE(notes.find("lie flatter than leaves turned at random"), std::string::npos) << notes;
}

TEST(LeafAnglesOfABlock, LeavesTurnedAtRandomAreLeftAsTheyAre) {
  const testing::Drive drive = drive_past(site_with(sim::LeafAngles::spherical));
  std::string notes;
  const double spherical = ratio_of(drive, LeafAngleType::spherical, notes);
  EXPECT_EQ(ratio_of(drive, LeafAngleType::measured, notes), spherical);
  EXPECT_EQ(notes.find("flatter"), std::string::npos) << notes;
}

// The wood is seen as the leaves are, so that what is alike in both cancels.
TEST(LeafAnglesOfABlock, WoodIsSubtractedAsTheLeavesAreSeen) {
  const testing::Drive leafy = drive_past(site_with(sim::LeafAngles::planophile));
  sim::Site bare = site_with(sim::LeafAngles::planophile);
  bare.dates[0].leaf_fraction = 0, bare.dates[0].seed = 32;
  Block block;
  block.add("2019-07-01", drive_past(bare), true);
  block.add("2019-08-01", leafy, false);
  const ProcessReport report = block.process();
  ASSERT_TRUE(report.scans.at(1).leaf_area_m2);
  const double leaf_m2 = *report.scans[1].leaf_area_m2, wood_m2 = report.scans[1].plant_area_m2 - leaf_m2;
  EXPECT_GT(wood_m2,
            1.05 * report.scans[0].plant_area_m2);  // as leaves that lie flat are: to level rays they are small
  // As near as the plants: on two short rows leaves come out less flat than they are, and a tenth of the area is lost.
  EXPECT_NEAR(leaf_m2 / leafy.leaf_area_m2, report.scans[1].plant_area_m2 / (leafy.leaf_area_m2 + leafy.wood_area_m2),
              0.05);
  // A second run finds all as it is and says the same.
  const ProcessReport again = block.process();
  EXPECT_EQ(again.scans.at(1).leaf_area_m2, report.scans[1].leaf_area_m2);
  EXPECT_EQ(again.scans[1].notes, report.scans[1].notes);
}

}  // namespace
}  // namespace rayfield::density
