#include "libdensity/leaf/leaf_products.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/libdensity/simulated_block.h"

namespace rayfield::density {
namespace {

using testing::Block;
using ::testing::Contains;
using testing::drive_with;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kHalf = 0.5;
constexpr std::uint64_t kFirst = 1, kSecond = 2, kThird = 3;

double leaf_area(const ScanResults& results) {
  double area = 0;
  for (const PanelValue& value : results.panel_values) area += value.leaf_area_m2;
  return area;
}

double plant_area(const ScanResults& results) {
  double area = 0;
  for (const PanelValue& value : results.panel_values) area += value.plant_area_m2;
  return area;
}

/// The sums of the panels' intervals hold the truth, and leaf areas of half metres and of the map add up to those of
/// the panels.
void expect_truth_held(Block& block, const std::string& scan_id, const testing::Drive& drive) {
  const ScanResults results = block.results(scan_id);
  double panels = 0, metres = 0, low = 0, high = 0;
  for (const PanelValue& value : results.panel_values) {
    panels += value.leaf_area_m2, low += value.ci_low_m2, high += value.ci_high_m2;
    EXPECT_LE(value.ci_low_m2, value.leaf_area_m2);
    EXPECT_GE(value.ci_high_m2, value.leaf_area_m2);
    EXPECT_EQ(value.wood_from, kWoodFromEstimate);
    EXPECT_EQ(value.wood_scan_id, "");
  }
  EXPECT_LE(low, drive.leaf_area_m2);
  EXPECT_GE(high, drive.leaf_area_m2);
  for (const RowMetreProduct& metre : results.row_metres) metres += 0.5 * metre.leaf_area_per_m;
  EXPECT_NEAR(metres, panels, 1e-6 * panels);
  double map = 0;
  const tile::Snapshot snapshot = block.snapshot();
  const auto scan = std::find_if(snapshot.scans.begin(), snapshot.scans.end(),
                                 [&](const tile::ScanEntry& entry) { return entry.scan_id == scan_id; });
  const RasterProduct raster = testing::take(load_raster(block.store(), snapshot, *scan, kLeafRasterName));
  for (const float cell : raster.grid.values)
    if (std::isfinite(cell)) map += static_cast<double>(cell) * raster.grid.cell_m * raster.grid.cell_m;
  EXPECT_NEAR(map, panels, 1e-4 * panels);
  EXPECT_EQ(results.scan.wood_from, kWoodFromEstimate);
  EXPECT_THAT(results.scan.leaf_note, HasSubstr("without a dormant scan"));
}

TEST(LeafProducts, WithoutADormantScanAreEstimatesWhoseIntervalsHoldTheTruth) {
  Block block;
  const testing::Drive& leafy = drive_with(kHalf, kFirst);
  block.add("2019-11-20", leafy);
  const ProcessReport report = block.process();
  EXPECT_EQ(report.scans[0].wood_from, kWoodFromEstimate);
  EXPECT_THAT(report.scans[0].notes, Contains(HasSubstr("without a dormant scan")));
  EXPECT_LT(report.scans[0].leaf_low_m2, leafy.leaf_area_m2);
  EXPECT_GT(report.scans[0].leaf_high_m2, leafy.leaf_area_m2);
  EXPECT_NEAR(*report.scans[0].leaf_area_m2, leaf_area(block.results("2019-11-20")), 1e-9);
  expect_truth_held(block, "2019-11-20", leafy);
  EXPECT_THAT(raster_names(block.snapshot().scans[0]), Contains(kLeafRasterName));
  EXPECT_EQ(block.process().scans[0].files_made, 0U);
}

TEST(LeafProducts, OfABareScanThatIsTakenForALeafyOneReachDownToNone) {
  Block block;
  const testing::Drive& bare = drive_with(0, kSecond);
  block.add("2019-10-05", bare);
  const ProcessReport report = block.process();
  ASSERT_EQ(report.scans[0].wood_from, kWoodFromEstimate) << "of no leafless month";
  EXPECT_THAT(report.scans[0].notes, Contains(HasSubstr("may be wood alone")));
  for (const PanelValue& value : block.results("2019-10-05").panel_values) {
    EXPECT_EQ(value.ci_low_m2, 0);
    EXPECT_LT(value.leaf_area_m2, 0.5 * value.ci_high_m2);
  }
}

TEST(LeafProducts, WithoutADormantScanAreFreedOfNoMoreThanTheBarestScanOfTheSeasonShows) {
  Block block;
  const testing::Drive& leafy = drive_with(kHalf, kFirst);
  block.add("2019-11-20", leafy);
  block.process();
  const ScanResults alone = block.results("2019-11-20");
  block.add("2019-10-05", drive_with(0, kSecond));
  EXPECT_THAT(block.process({"2019-10-05"}).outdated_leaf_areas, ElementsAre("2019-11-20"));
  const ProcessReport report = block.process();
  EXPECT_THAT(report.scans[1].notes, Contains(HasSubstr("no more than what 2019-10-05 shows")));
  EXPECT_THAT(report.scans[0].notes, Not(Contains(HasSubstr("barest")))) << "it is the barest itself";
  expect_truth_held(block, "2019-11-20", leafy);
  const ScanResults with = block.results("2019-11-20"), barest = block.results("2019-10-05");
  for (std::size_t i = 0; i < with.panel_values.size(); ++i) {
    EXPECT_EQ(with.panel_values[i].plant_area_m2, alone.panel_values[i].plant_area_m2);
    EXPECT_LE(with.panel_values[i].plant_area_m2 - with.panel_values[i].leaf_area_m2,
              barest.panel_values[i].plant_area_m2);
    EXPECT_GT(with.panel_values[i].ci_low_m2, alone.panel_values[i].ci_low_m2);
  }
  const double error = std::abs(leaf_area(with) - leafy.leaf_area_m2);
  EXPECT_LT(error, std::abs(leaf_area(alone) - leafy.leaf_area_m2));
  EXPECT_LT(error, 0.06 * leafy.leaf_area_m2);
  const ProcessReport again = block.process();
  EXPECT_EQ(again.scans[0].files_made + again.scans[1].files_made, 0U);
  EXPECT_THAT(again.outdated_leaf_areas, IsEmpty());
}

TEST(LeafProducts, OfABareScanAloneInWinterAreZero) {
  Block block;
  block.add("2019-08-01", drive_with(0, kSecond));
  const ProcessReport report = block.process();
  EXPECT_EQ(report.scans[0].wood_from, kWoodFromDormantScan);
  EXPECT_EQ(report.scans[0].leaf_area_m2, 0);
}

TEST(LeafProducts, HoldTheWoodWhereTheUserDoesNotWantItEstimated) {
  Block block;
  block.add("2019-11-20", drive_with(kHalf, kFirst));
  ProcessOptions options;
  options.wood.enabled = false;
  const ProcessReport report = block.process({}, options);
  EXPECT_EQ(report.scans[0].leaf_area_m2, std::nullopt);
  EXPECT_THAT(report.scans[0].notes, Contains(HasSubstr("the block has no dormant scan")));
  const ScanResults results = block.results("2019-11-20");
  EXPECT_THAT(results.scan.leaf_note, HasSubstr("holds canes and wires"));
  EXPECT_EQ(results.scan.wood_from, "");
  EXPECT_EQ(results.panel_values[0].wood_scan_id, "");
  EXPECT_GT(leaf_area(results), 1.1 * drive_with(kHalf, kFirst).leaf_area_m2);
  for (const PanelValue& value : results.panel_values) {
    EXPECT_EQ(value.se_plant_area_m2, value.se_leaf_area_m2);
    EXPECT_NEAR(value.plant_ci_high_m2 - value.plant_area_m2, value.ci_high_m2 - value.leaf_area_m2, 1e-9);
    EXPECT_NEAR(value.plant_area_m2 - value.plant_ci_low_m2, value.leaf_area_m2 - value.ci_low_m2, 1e-9);
    EXPECT_GT(value.plant_ci_high_m2 - value.plant_area_m2, 1.9 * value.se_plant_area_m2);
  }
  EXPECT_THAT(raster_names(block.snapshot().scans[0]), Not(Contains(kLeafRasterName)));
  EXPECT_EQ(block.process({}, options).scans[0].files_made, 0U);
}

TEST(LeafProducts, ADormantScanAddedLaterChangesLeafAreasAndNothingElse) {
  Block block;
  const testing::Drive& leafy = drive_with(kHalf, kFirst);
  block.add("2019-11-20", leafy);
  block.process();
  const auto before = block.derived("2019-11-20");
  const ScanResults with_wood = block.results("2019-11-20");

  block.add("2019-08-01", drive_with(0, kSecond));
  const ProcessReport report = block.process();
  for (const auto& [name, path] : before) {
    const bool of_leaves = name == "leaf/block" || name == std::string("raster/") + kLeafRasterName;
    EXPECT_EQ(block.derived("2019-11-20")[name] != path, of_leaves) << name << ": the dormant scan takes over";
  }
  const tile::Snapshot snapshot = block.snapshot();
  std::size_t wood_files = 0;
  for (const auto& [name, path] : block.derived("2019-11-20")) wood_files += name.rfind("voxels/wood_", 0) == 0 ? 1 : 0;
  EXPECT_GT(wood_files, 0U);
  ASSERT_EQ(report.scans.size(), 2U);
  EXPECT_EQ(report.scans[1].files_made, wood_files + 2) << "counted wood, leaf areas and their map";
  EXPECT_EQ(report.scans[1].wood_scan_id, "2019-08-01");

  const ScanResults results = block.results("2019-11-20");
  EXPECT_EQ(results.scan.wood_scan_id, "2019-08-01");
  EXPECT_EQ(results.scan.leaf_note, "");
  EXPECT_EQ(results.scan.wood_from, kWoodFromDormantScan);
  EXPECT_EQ(results.panel_values[0].wood_scan_id, "2019-08-01");
  EXPECT_EQ(plant_area(results), plant_area(with_wood));
  EXPECT_NEAR(leaf_area(results), leafy.leaf_area_m2, 0.06 * leafy.leaf_area_m2);
  EXPECT_NEAR(leaf_area(results), *report.scans[1].leaf_area_m2, 1e-9);
  double metres = 0;
  for (const RowMetreProduct& metre : results.row_metres) metres += 0.5 * metre.leaf_area_per_m;
  EXPECT_NEAR(metres, leaf_area(results), 1e-9 * metres);
  double map = 0;
  const RasterProduct raster = testing::take(load_raster(block.store(), snapshot, snapshot.scans[1], kLeafRasterName));
  for (const float cell : raster.grid.values)
    if (std::isfinite(cell)) map += static_cast<double>(cell) * raster.grid.cell_m * raster.grid.cell_m;
  EXPECT_NEAR(map, leaf_area(results), 1e-4 * map);
  for (const PanelValue& value : results.panel_values) {
    // Two scans' noise, but the wood's part of what comes whole is in the plants' alone: neither is much the larger.
    EXPECT_GT(value.se_leaf_area_m2, 0.5 * value.se_plant_area_m2);
    EXPECT_LT(value.se_leaf_area_m2, 2 * value.se_plant_area_m2);
    EXPECT_LT(value.ci_low_m2, value.leaf_area_m2);
    EXPECT_GT(value.ci_high_m2, value.leaf_area_m2);
  }

  const ProcessReport again = block.process();
  EXPECT_EQ(again.scans[0].files_made + again.scans[1].files_made, 0U);
}

TEST(LeafProducts, OfTheDormantScanItselfAreZeroAndOfAnotherBareDriveAboutZero) {
  Block block;
  block.add("2019-08-01", drive_with(0, kSecond));
  block.add("2020-07-20", drive_with(0, kThird), false);
  block.add("2019-11-20", drive_with(kHalf, kFirst));
  block.process();
  const ScanResults dormant = block.results("2019-08-01"), bare = block.results("2020-07-20");
  EXPECT_THAT(dormant.scan.leaf_note, HasSubstr("dormant"));
  EXPECT_EQ(bare.scan.wood_scan_id, "2019-08-01");
  for (const PanelValue& value : dormant.panel_values) {
    EXPECT_EQ(value.leaf_area_m2, 0);
    EXPECT_EQ(value.ci_low_m2, 0);
    EXPECT_GT(value.ci_high_m2, 0);
    EXPECT_GT(value.plant_area_m2, 0);
  }
  for (const RowMetreProduct& metre : dormant.row_metres) EXPECT_EQ(metre.leaf_area_per_m, 0);
  for (const PanelValue& value : bare.panel_values) {
    EXPECT_NEAR(value.leaf_area_m2, 0, 0.1);
    EXPECT_NE(value.leaf_area_m2, 0);
    EXPECT_GT(value.ci_high_m2, 0);
  }
}

TEST(LeafProducts, AFartherDormantScanChangesNothingAndANearerOneIsTaken) {
  Block block;
  block.add("2019-11-20", drive_with(kHalf, kFirst));
  block.add("2019-08-01", drive_with(0, kSecond));
  block.process();
  const auto before = block.derived("2019-11-20");
  block.add("2018-08-01", drive_with(0, kThird));
  const ProcessReport farther = block.process();
  EXPECT_EQ(farther.scans[2].files_made, 0U);
  EXPECT_EQ(block.derived("2019-11-20"), before);

  block.add("2019-09-05", drive_with(0, kThird));
  block.process();
  EXPECT_EQ(block.results("2019-11-20").scan.wood_scan_id, "2019-09-05");
  EXPECT_NE(block.derived("2019-11-20")["leaf/block"], before.at("leaf/block"));
  EXPECT_EQ(block.derived("2019-11-20")["results/block"], before.at("results/block"));
}

TEST(LeafProducts, AReplacedDormantScanHasLeafAreasMadeAnew) {
  Block block;
  block.add("2019-11-20", drive_with(kHalf, kFirst));
  block.add("2019-08-01", drive_with(0, kSecond));
  block.process();
  const auto before = block.derived("2019-11-20");
  block.add("2019-08-01", drive_with(0, kThird));
  block.process();
  EXPECT_NE(block.derived("2019-11-20")["leaf/block"], before.at("leaf/block"));
  EXPECT_EQ(block.derived("2019-11-20")["results/block"], before.at("results/block"));
}

TEST(LeafProducts, ARunOverTheDormantScanAloneNamesTheScansWhoseLeafAreasAreOutOfDate) {
  Block block;
  block.add("2019-11-20", drive_with(kHalf, kFirst));
  block.process();
  block.add("2019-08-01", drive_with(0, kSecond));
  EXPECT_THAT(block.process({"2019-08-01"}).outdated_leaf_areas, ElementsAre("2019-11-20"));
  EXPECT_EQ(block.results("2019-11-20").scan.wood_scan_id, "") << "as it was";
  EXPECT_THAT(block.process().outdated_leaf_areas, IsEmpty());
  EXPECT_EQ(block.results("2019-11-20").scan.wood_scan_id, "2019-08-01");
  EXPECT_THAT(block.process({"2019-08-01"}).outdated_leaf_areas, IsEmpty());
}

TEST(LeafProducts, WhatIsSaidOfAScanRulesAndCanBeTakenBack) {
  Block block;
  block.add("2019-11-20", drive_with(kHalf, kFirst));
  block.add("2019-08-01", drive_with(0, kSecond));
  block.process();
  ASSERT_EQ(block.results("2019-11-20").scan.wood_scan_id, "2019-08-01");
  ASSERT_TRUE(block.store().set_dormant("2019-08-01", false, "test"));
  const ProcessReport report = block.process();
  EXPECT_EQ(block.results("2019-11-20").scan.wood_scan_id, "");
  EXPECT_EQ(block.results("2019-11-20").scan.wood_from, kWoodFromEstimate);
  EXPECT_THAT(report.scans[0].notes, Contains(HasSubstr("not dormant, as declared")));
  EXPECT_THAT(report.scans[1].notes, Contains(HasSubstr("without a dormant scan")));
}

}  // namespace
}  // namespace rayfield::density
