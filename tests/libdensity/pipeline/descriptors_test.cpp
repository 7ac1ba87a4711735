#include <gtest/gtest.h>

#include <cmath>

#include "tests/libdensity/simulated_block.h"

namespace rayfield::density {
namespace {

using testing::Block;
using testing::drive_with;

constexpr std::uint64_t kFirst = 1, kSecond = 2;
constexpr double kFull = 1;

double mean_of(const ScanResults& results, double CanopyDescriptors::*member) {
  double sum = 0;
  for (const PanelValue& value : results.panel_values) sum += value.descriptors.*member;
  return sum / static_cast<double>(results.panel_values.size());
}

double mean_of(const ScanResults& results, double PanelValue::*member) {
  double sum = 0;
  for (const PanelValue& value : results.panel_values) sum += value.*member;
  return sum / static_cast<double>(results.panel_values.size());
}

double true_mean(const testing::Drive& drive, double sim::CanopyTruth::*member) {
  double sum = 0, count = 0;
  for (const sim::RowCanopy& row : drive.canopy)
    for (const sim::CanopyTruth& panel : row.panels) sum += panel.*member, ++count;
  return sum / count;
}

/// True leaf area between two heights, m² per metre of row.
double true_zone(const testing::Drive& drive, double low_m, double high_m) {
  double area = 0;
  for (const sim::RowCanopy& row : drive.canopy)
    for (const auto& profile : row.profiles)
      for (const sim::CanopyBand& band : profile)
        if (band.low_m > low_m - 1e-6 && band.high_m < high_m + 1e-6) area += band.leaf_m2;
  return area / (2 * 14);
}

TEST(CanopyDescriptorsOfAScan, AreThoseOfTheSimulatedLeaves) {
  Block block;
  const testing::Drive& leafy = drive_with(kFull, kFirst);
  block.add("2019-08-01", drive_with(0, kSecond));
  block.add("2020-01-20", leafy);
  block.process();
  const ScanResults results = block.results("2020-01-20");
  ASSERT_EQ(results.panel_values.size(), 8U);
  const double layers = true_mean(leafy, &sim::CanopyTruth::leaf_layer_number);
  EXPECT_NEAR(mean_of(results, &CanopyDescriptors::leaf_layer_number), layers, 0.08 * layers);
  EXPECT_NEAR(mean_of(results, &CanopyDescriptors::porosity), true_mean(leafy, &sim::CanopyTruth::porosity), 0.03);
  EXPECT_NEAR(mean_of(results, &CanopyDescriptors::exposed_leaf_share),
              true_mean(leafy, &sim::CanopyTruth::exposed_leaf_share), 0.04);
  EXPECT_NEAR(mean_of(results, &PanelValue::canopy_height_m), true_mean(leafy, &sim::CanopyTruth::height_m), 0.05);
  EXPECT_NEAR(mean_of(results, &PanelValue::canopy_width_m), true_mean(leafy, &sim::CanopyTruth::width_m), 0.08);
  EXPECT_NEAR(mean_of(results, &CanopyDescriptors::row_gap_share), true_mean(leafy, &sim::CanopyTruth::row_gap_share),
              0.03);
  const double zone = true_zone(leafy, 0.8, 1.2);  // the default, where the canopy's lower edge is
  EXPECT_NEAR(mean_of(results, &CanopyDescriptors::fruit_zone_area_per_m), zone, 0.1 * zone);
}

TEST(CanopyDescriptorsOfAScan, OfADormantOneAreOfWoodWithoutLeaves) {
  Block block;
  block.add("2019-08-01", drive_with(0, kSecond));
  block.add("2020-01-20", drive_with(kFull, kFirst));
  block.process();
  const ScanResults dormant = block.results("2019-08-01");
  for (const PanelValue& value : dormant.panel_values) {
    EXPECT_EQ(value.descriptors.leaf_layer_number, 0);
    EXPECT_EQ(value.descriptors.fruit_zone_area_per_m, 0);
    EXPECT_TRUE(std::isnan(value.descriptors.exposed_leaf_share));
    EXPECT_GT(value.descriptors.porosity, 0.7) << "canes and wires";
    EXPECT_LT(value.descriptors.porosity, 1);
  }
}

TEST(CanopyDescriptorsOfAScan, HaveProfilesThatAddUpToTheAreasOfPanels) {
  Block block;
  block.add("2019-08-01", drive_with(0, kSecond));
  block.add("2020-01-20", drive_with(kFull, kFirst));
  block.process();
  for (const char* scan : {"2019-08-01", "2020-01-20"}) {
    const ScanResults results = block.results(scan);
    for (const PanelValue& value : results.panel_values) {
      double leaf = 0, plant = 0;
      for (const PanelProfileBand& band : results.profile)
        if (band.panel_uid == value.panel_uid) leaf += band.leaf_area_m2, plant += band.plant_area_m2;
      EXPECT_NEAR(leaf, value.leaf_area_m2, 1e-9 * plant);
      EXPECT_NEAR(plant, value.plant_area_m2, 1e-9 * plant);
    }
  }
}

TEST(CanopyDescriptorsOfAScan, AreMadeAnewForAnotherFruitZoneAndAtAnyNumberOfThreads) {
  Block block;
  block.add("2019-08-01", drive_with(0, kSecond));
  block.add("2020-01-20", drive_with(kFull, kFirst));
  ProcessOptions options;
  options.threads = 1;
  block.process({}, options);
  const auto files = block.derived("2020-01-20");
  options.descriptors.fruit_zone_low_m = 1.2, options.descriptors.fruit_zone_high_m = 1.6;
  block.process({}, options);
  EXPECT_NE(block.derived("2020-01-20")["results/block"], files.at("results/block"));
  EXPECT_NE(block.derived("2020-01-20")["leaf/block"], files.at("leaf/block"));
  const ScanResults higher = block.results("2020-01-20");
  EXPECT_EQ(higher.scan.fruit_zone_low_m, 1.2);
  const double zone = true_zone(drive_with(kFull, kFirst), 1.2, 1.6);
  EXPECT_NEAR(mean_of(higher, &CanopyDescriptors::fruit_zone_area_per_m), zone, 0.1 * zone);
  options = {};
  options.threads = 3, options.redo = true;
  block.process({}, options);
  EXPECT_EQ(block.derived("2020-01-20"), files) << "the paths hold the hashes of what is in the files";
}

}  // namespace
}  // namespace rayfield::density
