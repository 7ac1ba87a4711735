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

/// A wall of 3.5 m²/m through a beam of 8 mm + 2 mrad that does not see what takes less than 0.39 of it.
testing::Drive narrow_drive(sim::LeafAngles angles) {
  sim::Site site = site_with(angles);
  site.canopy.leaf_area_m2_per_m = 3.5;
  site.lidar.beam_diameter_m = 0.008, site.lidar.divergence_mrad = 2;
  site.lidar.keeps_downward_misses = true;  // as of a registered log
  site.spinning.beams = 286;                // so that there are full echoes
  site.lidar.detection_share = 0.39, site.lidar.detection = sim::Detection::returned_energy;
  return drive_past(site);
}

// Beams that have come deep have lost of themselves, however narrow, and level ones come deeper than steep ones: that
// is not how leaves are turned. Taken for it, spherical leaves read 1.5 of their area. (With half of the rays the two
// short rows have one or two full echoes, the mean echo alone tells what one is, 8 % too little, and spherical leaves
// read 1.18, as far off as their interval says.)
TEST(LeafAnglesOfABlock, WhatNarrowBeamsLoseIsNotTakenForFlatLeaves) {
  for (const auto angles : {sim::LeafAngles::spherical, sim::LeafAngles::planophile}) {
    const testing::Drive drive = narrow_drive(angles);
    Block block;
    block.add("2019-08-01", drive, false, LidarBeam{0.008, 0.002, {}});
    const ProcessReport report = block.process();
    const ScanReport& scan = report.scans.at(0);
    const double ratio = scan.plant_area_m2 / (drive.leaf_area_m2 + drive.wood_area_m2);
    EXPECT_NEAR(ratio, 1, 0.1);
    std::string notes;
    for (const std::string& note : scan.notes) notes += note + "\n";
    EXPECT_EQ(notes.find("lie flatter") != std::string::npos, angles == sim::LeafAngles::planophile) << notes;
  }
}

}  // namespace
}  // namespace rayfield::density
