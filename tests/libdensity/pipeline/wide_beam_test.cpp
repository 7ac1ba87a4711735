#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libdensity/scan/scan_echoes.h"
#include "tests/libdensity/simulated_block.h"

/// Blocks seen by a lidar whose beam is as wide as a leaf.
namespace rayfield::density {
namespace {

using testing::Block;
using ::testing::Contains;
using ::testing::HasSubstr;

const LidarBeam kBeam{0.0136, 0.0119, {}};

testing::Drive wide_drive(double leaf_fraction, std::uint64_t seed, double resolution_m = 0.15,
                          double detection_share = 0.25) {
  sim::Site site = testing::block_site(leaf_fraction, seed);
  site.lidar.range_resolution_m = resolution_m;
  site.lidar.beam_diameter_m = kBeam.diameter_m, site.lidar.divergence_mrad = 1000 * kBeam.divergence_rad;
  site.lidar.detection_share = detection_share, site.lidar.detection = sim::Detection::returned_energy;
  // Energy is covered share: dark wood reads low, which is not the beam's doing (docs/beams.md, "How far it can be
  // trusted").
  site.reflectance.wood = site.reflectance.post = site.reflectance.wire = site.reflectance.leaf;
  return testing::drive_past(site);
}

struct Areas {
  double plant_m2 = 0, leaf_m2 = 0;
  int held = 0, panels = 0;
};
Areas areas_of(const ScanResults& results) {
  Areas areas;
  for (const PanelValue& value : results.panel_values) {
    areas.plant_m2 += value.plant_area_m2, areas.leaf_m2 += value.leaf_area_m2;
    ++areas.panels;
  }
  return areas;
}

TEST(WideBeam, ItsWidthIsTakenOutOfTheAreas) {
  Block block;
  const testing::Drive leafy = wide_drive(1, 3), bare = wide_drive(0, 4);
  block.add("2019-08-01", bare, true, kBeam);
  block.add("2020-01-20", leafy, std::nullopt, kBeam);
  const ProcessReport report = block.process();
  EXPECT_THAT(report.scans[1].notes, Contains(HasSubstr("37 mm wide at 2 m, which is taken out")));
  const Areas found = areas_of(block.results("2020-01-20"));
  const double plants = leafy.leaf_area_m2 + leafy.wood_area_m2;
  EXPECT_NEAR(found.plant_m2 / plants, 1, 0.10);
  EXPECT_NEAR(found.leaf_m2 / leafy.leaf_area_m2, 1, 0.12);
  EXPECT_EQ(areas_of(block.results("2019-08-01")).leaf_m2, 0);

  ProcessOptions counted;
  counted.beam.enabled = false;
  block.process({}, counted);
  EXPECT_GT(areas_of(block.results("2020-01-20")).plant_m2 / plants, 1.12);
}

// Canes are a fraction of the beam, which low detection shares see all the same: counted, they are twice as many.
TEST(WideBeam, BareVinesAreWeighedByTheirPosts) {
  Block block;
  const testing::Drive bare = wide_drive(0, 4, 0.15, 0.12);
  block.add("2019-08-01", bare, true, kBeam);
  const ProcessReport report = block.process();
  EXPECT_THAT(report.scans[0].notes, Contains(HasSubstr("taken out as of bare vines")));
  EXPECT_NEAR(areas_of(block.results("2019-08-01")).plant_m2 / bare.wood_area_m2, 1, 0.15);
  ProcessOptions counted;
  counted.beam.enabled = false;
  block.process({}, counted);
  EXPECT_GT(areas_of(block.results("2019-08-01")).plant_m2 / bare.wood_area_m2, 1.5);
}

// Where neither the rig nor SLAM says it, the ground does.
TEST(WideBeam, ItsRangeResolutionIsMeasured) {
  for (const double truth : {0.09, 0.24}) {
    Block block;
    block.add("2020-01-20", wide_drive(1, 3, truth), std::nullopt, kBeam);
    block.process();
    const tile::Snapshot snapshot = block.snapshot();
    const auto model = testing::take(read_echoes(block.store(), *snapshot.find_scan("2020-01-20")));
    ASSERT_TRUE(model);
    EXPECT_NEAR(model->range_resolution_m, truth, 0.03);
    EXPECT_FALSE(model->resolution_assumed);
  }
}

TEST(WideBeam, WhatIsDoneAgainGivesTheSameAndAnUnchangedScanIsLeft) {
  Block block;
  const testing::Drive leafy = wide_drive(1, 3);
  block.add("2020-01-20", leafy, std::nullopt, kBeam);
  ProcessOptions one;
  one.threads = 1;
  const ProcessReport first = block.process({}, one);
  const auto files = block.derived("2020-01-20");
  ProcessOptions again;
  again.threads = 2, again.redo = true;
  block.process({}, again);
  EXPECT_EQ(block.derived("2020-01-20"), files);
  const ProcessReport kept = block.process();
  EXPECT_EQ(kept.scans[0].files_made, 0u);
  EXPECT_EQ(kept.scans[0].notes, first.scans[0].notes);
}

}  // namespace
}  // namespace rayfield::density
