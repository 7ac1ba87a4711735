#include "rayfield/density/zones.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rayfield::density {
namespace {

ManagementZone square_zone(int number, double x0, double y0, double x1, double y1) {
  ManagementZone zone;
  zone.zone = number;
  zone.parts.push_back({{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}}, {}});
  return zone;
}

TEST(ValueSurface, AConstantStaysConstantUpToAndBeyondTheBorders) {
  std::vector<ZoneSample> samples;
  for (int i = 0; i < 40; ++i) samples.push_back({{0.5 * i, 2.5 * (i % 4)}, i < 39 ? 3.0 : 3.25, 0.5});
  samples.back().value = 3.0;
  samples.push_back({{10, 5}, 3.0 + 1e-9, 0.5});
  ZoneOptions options;
  options.classes = 2, options.smoothing_m = 1;
  const auto surface = value_surface(samples, 30, options);
  ASSERT_TRUE(surface) << surface.error().line();
  for (const double value : surface->values.values) ASSERT_NEAR(value, 3.0, 1e-8);
}

TEST(ValueSurface, TheBreakBetweenTwoHalvesLiesBetweenTheirValues) {
  std::vector<ZoneSample> samples;
  for (int row = 0; row < 8; ++row)
    for (int i = 0; i < 120; ++i) samples.push_back({{0.5 * i, 2.5 * row}, i < 60 ? 1.0 : 4.0, 0.5});
  ZoneOptions options;
  options.classes = 2, options.smoothing_m = 2;
  const auto surface = value_surface(samples, 5, options);
  ASSERT_TRUE(surface);
  ASSERT_EQ(surface->breaks.size(), 1U);
  // By symmetry the two classes mirror each other about the mean.
  EXPECT_NEAR(surface->breaks[0], 2.5, 0.1);
}

TEST(ValueSurface, WithoutValuesThereAreNoZones) {
  const auto surface = value_surface({}, 5, {});
  ASSERT_FALSE(surface);
  EXPECT_EQ(surface.error().code, ErrorCode::bad_input);
}

TEST(ValueSurface, OptionsOutOfRangeAreRefused) {
  ZoneOptions options;
  options.classes = 9;
  const auto surface = value_surface({}, 5, options);
  ASSERT_FALSE(surface);
  EXPECT_EQ(surface.error().code, ErrorCode::usage);
}

TEST(RowSamples, LeaveOutHalfMetresThatWereNotSeen) {
  ScanResults scan;
  scan.row_metres.push_back({1, 0.25, {0, 0}, "a", "2019-02-11", 2.0, 3.0});
  scan.row_metres.push_back({1, 0.75, {0, 0.5}, "a", "2019-02-11", std::nan(""), 3.0});
  const auto samples = row_samples(scan);
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].value, 2.0);
  EXPECT_EQ(samples[0].weight, 0.5);
}

TEST(MapSamples, HoldTheSumOfTheMap) {
  Grid2<float> map({100, 200}, 0.1, 37, 23);
  double sum = 0;
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    map.values[i] = i % 5 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(i % 7);
    if (i % 5 != 0) sum += static_cast<double>(i % 7) * 0.01;
  }
  double of_samples = 0;
  for (const ZoneSample& sample : map_samples(map, 1)) of_samples += sample.value * sample.weight;
  EXPECT_NEAR(of_samples, sum, 1e-9);
}

TEST(RowBands, CoverTheGroundOfTheRowsThatStandOnTheDate) {
  std::vector<RowProduct> rows(3);
  for (std::size_t i = 0; i < 3; ++i) {
    rows[i].centreline = {{0, 2.5 * static_cast<double>(i)}, {40, 2.5 * static_cast<double>(i)}};
    rows[i].spacing_m = 2.5;
  }
  rows[2].valid_to = "2019-01-01";
  EXPECT_EQ(row_bands(rows, "2018-12-31").size(), 3U);
  const auto bands = row_bands(rows, "2019-01-01");
  ASSERT_EQ(bands.size(), 2U);
  EXPECT_EQ(bands[0][0], Eigen::Vector2d(0, -1.25));
  EXPECT_EQ(bands[0][2], Eigen::Vector2d(40, 1.25));
}

TEST(SmallestZone, IsAQuarterOfAMeanZoneOnSmallBlocks) {
  const std::vector<std::vector<Eigen::Vector2d>> bands = {{{9, 9}, {49, 9}, {49, 19}, {9, 19}, {9, 9}}};
  ZoneOptions options;
  options.classes = 4, options.min_zone_m2 = 200;
  EXPECT_NEAR(smallest_zone_m2(bands, options), 400.0 / 4 / 4, 1e-9);
  options.min_zone_m2 = 20;
  EXPECT_EQ(smallest_zone_m2(bands, options), 20);
}

TEST(SamplesOn, LeaveOutWhatLiesBesideTheRows) {
  std::vector<RowProduct> rows(2);
  for (std::size_t i = 0; i < 2; ++i) {
    rows[i].centreline = {{0, 2.5 * static_cast<double>(i)}, {40, 2.5 * static_cast<double>(i)}};
    rows[i].spacing_m = 2.5;
  }
  const std::vector<ZoneSample> samples = {
      {{20, 0.1}, 1, 1}, {{20, 3.7}, 2, 1}, {{20, 3.8}, 3, 1}, {{-0.1, 0}, 4, 1}, {{20, -1.3}, 5, 1}};
  const auto kept = samples_on(row_bands(rows, "2019-01-01"), samples);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].value, 1);
  EXPECT_EQ(kept[1].value, 2);
}

TEST(MeasureZones, MeansAreWeightedAndNoSampleCountsTwice) {
  std::vector<ManagementZone> zones = {square_zone(1, 0, 0, 2, 2), square_zone(2, 2, 0, 4, 2)};
  const std::vector<ZoneSample> samples = {
      {{1, 1}, 1.0, 0.5}, {{1.5, 1}, 4.0, 1.0}, {{2, 1}, 5.0, 0.5}, {{3, 1}, 7.0, 0.5}, {{9, 9}, 100, 0.5}};
  measure_zones(samples, zones);
  EXPECT_NEAR(zones[0].measured + zones[1].measured, 2.5, 1e-12) << "the sample on the border belongs to one of them";
  EXPECT_NEAR(zones[0].measured * zones[0].mean + zones[1].measured * zones[1].mean, 0.5 + 4 + 2.5 + 3.5, 1e-12);
  EXPECT_EQ(zones[0].min, 1.0);
  EXPECT_EQ(zones[1].max, 7.0);
}

TEST(MeasureZones, TellHowMuchOfTheVarianceLiesBetweenZones) {
  std::vector<ManagementZone> zones = {square_zone(1, 0, 0, 2, 2), square_zone(2, 2, 0, 4, 2)};
  // Means 2 and 6 about 4: between zones 4, within them 1, of equal weight.
  const std::vector<ZoneSample> samples = {{{1, 1}, 1, 1}, {{1.5, 1}, 3, 1}, {{3, 1}, 5, 1}, {{3.5, 1}, 7, 1}};
  EXPECT_NEAR(measure_zones(samples, zones), 4.0 / 5.0, 1e-12);
  const std::vector<ZoneSample> even = {{{1, 1}, 3, 1}, {{3, 1}, 3, 1}};
  EXPECT_TRUE(std::isnan(measure_zones(even, zones)));
}

TEST(MeasureZones, AZoneWithoutSamplesHasNoMean) {
  std::vector<ManagementZone> zones = {square_zone(1, 0, 0, 2, 2)};
  zones[0].parts[0].holes.push_back({{0.5, 0.5}, {0.5, 1.5}, {1.5, 1.5}, {1.5, 0.5}, {0.5, 0.5}});
  measure_zones(std::vector<ZoneSample>{{{1, 1}, 1.0, 0.5}}, zones);
  EXPECT_TRUE(std::isnan(zones[0].mean)) << "the sample lies in the hole";
}

}  // namespace
}  // namespace rayfield::density
