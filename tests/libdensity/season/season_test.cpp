#include "rayfield/density/season.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/libdensity/season/seasons.h"

namespace rayfield::density {
namespace {

using testing::block_of;
using testing::value_of;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

PanelValue unseen() {
  PanelValue v = value_of(0, 0, 0);
  v.leaf_area_m2 = v.plant_area_m2 = v.se_leaf_area_m2 = v.ci_high_m2 = kNaN;
  return v;
}

TEST(Season, RowsAndTheBlockAreTheirPanelsTogetherWithBothErrors) {
  // Two rows of two panels of 6 m on one date.
  const BlockProducts block = block_of(
      {{value_of(12, 0.3, 0.025), value_of(18, 0.4, 0.025), value_of(6, 0.2, 0.025), value_of(6, 0.2, 0.025)}});
  const auto values = season_values(block);
  ASSERT_EQ(values.size(), 3U);
  EXPECT_EQ(values[0].row_number, 0) << "the block comes first";
  EXPECT_NEAR(values[0].leaf_area_per_m, 42.0 / 24, 1e-12);
  EXPECT_EQ(values[1].row_number, 1);
  EXPECT_NEAR(values[1].leaf_area_m2, 30, 1e-12);
  EXPECT_NEAR(values[1].plant_area_m2, 33, 1e-12);
  EXPECT_NEAR(values[1].leaf_area_per_m, 2.5, 1e-12);
  // √(0.09 + 0.16 + (0.025·30)²)·1.96/12
  EXPECT_NEAR(values[1].ci_high_per_m - 2.5, testing::kRoot * std::hypot(0.5, 0.75) / 12, 1e-9);
  EXPECT_NEAR(2.5 - values[1].ci_low_per_m, testing::kRoot * std::hypot(0.5, 0.75) / 12, 1e-9);
}

TEST(Season, WhereTheWoodIsEstimatedTheFurtherEndOfAPanelsIntervalCounts) {
  BlockProducts block = block_of({{value_of(12, 0.3, 0.025)}});
  PanelValue& value = block.scans[0].panel_values[0];
  const double near = value.ci_high_m2 - value.leaf_area_m2;
  value.ci_low_m2 = value.leaf_area_m2 - 5;
  EXPECT_NEAR(season_values(block)[0].ci_high_per_m - 2, near / 6, 1e-9);
  value.wood_from = kWoodFromEstimate;
  EXPECT_NEAR(season_values(block)[0].ci_high_per_m - 2, 5.0 / 6, 1e-9);
  EXPECT_NEAR(2 - season_values(block)[0].ci_low_per_m, 5.0 / 6, 1e-9);
}

TEST(Season, WhatWasNotSeenIsLeftOutAndCounted) {
  const auto values = season_values(block_of(
      {{value_of(12, 0.3, 0.025), unseen(), unseen(), unseen()},
       {value_of(12, 0.3, 0.025), value_of(12, 0.3, 0.025), value_of(12, 0.3, 0.025), value_of(12, 0.3, 0.025)}}));
  ASSERT_EQ(values.size(), 6U);
  EXPECT_EQ(values[1].panels, 2U);
  EXPECT_EQ(values[1].panels_seen, 1U);
  EXPECT_NEAR(values[1].length_m, 6, 1e-12);
  EXPECT_NEAR(values[1].leaf_area_per_m, 2, 1e-12) << "per metre of what was seen";
  EXPECT_EQ(values[2].panels_seen, 0U);
  EXPECT_TRUE(std::isnan(values[2].leaf_area_m2) && std::isnan(values[2].leaf_area_per_m));
  EXPECT_EQ(values[3].scan_id, "2021-02-01");
  EXPECT_EQ(values[5].panels_seen, 2U);
}

}  // namespace
}  // namespace rayfield::density
