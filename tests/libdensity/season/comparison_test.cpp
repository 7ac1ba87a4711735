#include "rayfield/density/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/libdensity/season/seasons.h"

namespace rayfield::density {
namespace {

using testing::block_of;
using testing::value_of;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Comparison, AChangeHasTheErrorCalculatedByHand) {
  // s = 0.3 and 0.4, c = 2.5 % of 20 and 22: 0.09 + 0.16 + 0.25 + 0.3025 − 2·0.8·0.5·0.55 = 0.3625.
  const auto result = compare_dates(block_of({{value_of(20, 0.3, 0.025)}, {value_of(22, 0.4, 0.025)}}), 0, 1,
                                    {.error_correlation = 0.8});
  ASSERT_TRUE(result.has_value()) << result.error().line();
  const PanelChange& panel = result->panels.at(0);
  EXPECT_NEAR(panel.leaf_change_m2, 2, 1e-12);
  EXPECT_NEAR(panel.leaf_change_per_m, 2.0 / 6, 1e-12);
  EXPECT_NEAR(panel.leaf_change_percent, 10, 1e-12);
  EXPECT_NEAR(panel.plant_change_m2, 2, 1e-12);
  EXPECT_NEAR(panel.se_change_m2, std::sqrt(0.3625), 1e-9);
  EXPECT_NEAR(panel.ci_low_m2, 2 - testing::kRoot * std::sqrt(0.3625), 1e-9);
  EXPECT_NEAR(panel.ci_high_m2, 2 + testing::kRoot * std::sqrt(0.3625), 1e-9);
  EXPECT_NEAR(panel.p_value, 8.94e-4, 1e-5);  // 2·(1 − Φ(3.3218))
  EXPECT_EQ(panel.verdict, ChangeVerdict::gain);
  EXPECT_EQ(result->gains, 1U);
  EXPECT_EQ(result->losses, 0U);
  // One panel: the sum is the panel.
  EXPECT_NEAR(result->leaf_total.se_m2, panel.se_change_m2, 1e-12);
}

TEST(Comparison, TheOtherWayRoundIsTheSameChangeWithTheOtherSign) {
  const BlockProducts block = block_of(
      {{value_of(20, 0.3, 0.025), value_of(15, 0.3, 0.025)}, {value_of(22, 0.4, 0.025), value_of(15.1, 0.3, 0.025)}});
  const auto forth = compare_dates(block, 0, 1, {}), back = compare_dates(block, 1, 0, {});
  ASSERT_TRUE(forth.has_value() && back.has_value());
  EXPECT_EQ(back->losses, forth->gains);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back->panels[i].leaf_change_m2, -forth->panels[i].leaf_change_m2);
    EXPECT_NEAR(back->panels[i].se_change_m2, forth->panels[i].se_change_m2, 1e-12);
  }
  EXPECT_NEAR(back->leaf_per_m.rrmse, forth->leaf_per_m.rrmse, 1e-12);
}

TEST(Comparison, AnErrorThatBothDatesShareWhollyOnlyScalesTheChange) {
  // Without errors of the voxels: c_a − c_b = 2.5 % of the change, whatever the areas are.
  const auto result =
      compare_dates(block_of({{value_of(100, 0, 0.025)}, {value_of(101, 0, 0.025)}}), 0, 1, {.error_correlation = 1});
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->panels[0].se_change_m2, 0.025, 1e-7);
  const auto apart =
      compare_dates(block_of({{value_of(100, 0, 0.025)}, {value_of(101, 0, 0.025)}}), 0, 1, {.error_correlation = 0});
  EXPECT_NEAR(apart->panels[0].se_change_m2, 0.025 * std::hypot(100, 101), 1e-7);
}

TEST(Comparison, PanelsThatWereNotSeenOnADateAreCountedAndLeftOut) {
  PanelValue unseen = value_of(0, 0, 0);
  unseen.leaf_area_m2 = unseen.plant_area_m2 = unseen.se_leaf_area_m2 = unseen.ci_high_m2 = kNaN;
  BlockProducts block =
      block_of({{value_of(20, 0.3, 0.025), unseen, value_of(10, 0.2, 0.025), value_of(8, 0.2, 0.025)},
                {value_of(10, 0.3, 0.025), value_of(5, 0.1, 0.025), unseen, value_of(8, 0.2, 0.025)}});
  block.scans[1].panel_values.pop_back();  // the fourth has no line at all
  const auto result = compare_dates(block, 0, 1, {});
  ASSERT_TRUE(result.has_value()) << result.error().line();
  EXPECT_EQ(result->compared, 1U);
  EXPECT_EQ(result->not_seen, 3U);
  EXPECT_EQ(result->losses, 1U);
  ASSERT_EQ(result->panels.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_EQ(result->panels[i].verdict, ChangeVerdict::not_seen);
    EXPECT_TRUE(std::isnan(result->panels[i].leaf_change_m2));
    EXPECT_TRUE(std::isnan(result->panels[i].p_value));
  }
  EXPECT_NEAR(result->leaf_total.change_m2, -10, 1e-12);
  EXPECT_EQ(result->leaf_per_m.count, 1U);
}

TEST(Comparison, NegativeAndEmptyPanelsAreComparedLikeAnyOther) {
  // Leaf area is a difference of two estimates and may fall below 0 in a block without leaves.
  const auto result = compare_dates(
      block_of({{value_of(-0.2, 0.1, 0.025), value_of(0, 0, 0.025)}, {value_of(3, 0.1, 0.025), value_of(0, 0, 0.025)}}),
      0, 1, {});
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->panels[0].leaf_change_m2, 3.2, 1e-12);
  EXPECT_EQ(result->panels[0].verdict, ChangeVerdict::gain);
  EXPECT_TRUE(std::isnan(result->panels[0].leaf_change_percent));
  EXPECT_EQ(result->panels[1].leaf_change_m2, 0);
  EXPECT_EQ(result->panels[1].p_value, 1);
  EXPECT_EQ(result->panels[1].verdict, ChangeVerdict::none) << "nothing there on both dates";
}

TEST(Comparison, HalfMetresArePairedByRowAndPlace) {
  BlockProducts block = block_of({{value_of(20, 0.3, 0.025)}, {value_of(22, 0.4, 0.025)}});
  block.scans[0].row_metres = {{1, 0.25, {0, 0}, "", "", 2, 3}, {1, 0.75, {0, 0}, "", "", kNaN, kNaN}};
  block.scans[1].row_metres = {
      {1, 0.25, {0, 0}, "", "", 4, 5}, {1, 0.75, {0, 0}, "", "", 1, 1}, {2, 0.25, {0, 0}, "", "", 9, 9}};
  const auto result = compare_dates(block, 0, 1, {});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->half_metre_leaf_per_m.count, 1U);
  EXPECT_NEAR(result->half_metre_leaf_per_m.rrmse, 2.0 / 3, 1e-12);
  EXPECT_NEAR(result->half_metre_plant_per_m.rrmse, 0.5, 1e-12);
}

TEST(Comparison, WrongScansAndDatesWithoutACommonPanelAreRefused) {
  BlockProducts block = block_of({{value_of(20, 0.3, 0.025)}, {value_of(22, 0.4, 0.025)}});
  EXPECT_EQ(compare_dates(block, 0, 0, {}).error().code, ErrorCode::usage);
  EXPECT_EQ(compare_dates(block, 0, 2, {}).error().code, ErrorCode::usage);
  EXPECT_EQ(compare_dates(block, 0, 1, {.error_correlation = 1.5}).error().code, ErrorCode::usage);
  block.scans[1].panel_values.clear();
  EXPECT_EQ(compare_dates(block, 0, 1, {}).error().code, ErrorCode::bad_input);
}

// Panels with known truth, measured on two dates with errors of their own and errors that a scan's panels share.
class MonteCarlo {
 public:
  explicit MonteCarlo(double correlation) : correlation_(correlation) {}

  /// One date pair; with `each` every panel has shared errors of its own, so that panels are independent trials.
  BlockProducts measure(const std::vector<double>& truth_a, const std::vector<double>& truth_b, bool each) {
    std::vector<PanelValue> a, b;
    double shared_a = 0, shared_b = 0;
    for (std::size_t i = 0; i < truth_a.size(); ++i) {
      if (each || i == 0) {
        shared_a = kShared * normal_(rng_);
        shared_b = correlation_ * shared_a + std::sqrt(1 - correlation_ * correlation_) * kShared * normal_(rng_);
      }
      a.push_back(measured(truth_a[i], shared_a)), b.push_back(measured(truth_b[i], shared_b));
    }
    return block_of({a, b});
  }

 private:
  static constexpr double kShared = 0.025;
  PanelValue measured(double truth, double shared) {
    const double own = 0.12 * std::sqrt(truth);
    return value_of(truth * (1 + shared) + own * normal_(rng_), own, kShared);
  }
  double correlation_;
  std::mt19937_64 rng_{12};
  std::normal_distribution<double> normal_;
};

TEST(Comparison, OfUnchangedPanelsOneInTwentyIsCalledChanged) {
  const std::vector<double> truth(40000, 16);
  for (const double correlation : {0.0, 0.8, 1.0}) {
    MonteCarlo world(correlation);
    const auto result = compare_dates(world.measure(truth, truth, true), 0, 1, {.error_correlation = correlation});
    ASSERT_TRUE(result.has_value());
    const double n = static_cast<double>(truth.size());
    // Three standard deviations of a share of 2.5 % over 40 000 panels are 0.23 %.
    EXPECT_NEAR(static_cast<double>(result->gains) / n, 0.025, 0.0025) << correlation;
    EXPECT_NEAR(static_cast<double>(result->losses) / n, 0.025, 0.0025) << correlation;
  }
}

TEST(Comparison, TheIntervalHoldsTheTrueChangeInNineteenOfTwentyPanels) {
  const std::vector<double> before(40000, 10), after(40000, 25);
  for (const double correlation : {0.0, 0.8}) {
    MonteCarlo world(correlation);
    const auto result = compare_dates(world.measure(before, after, true), 0, 1, {.error_correlation = correlation});
    ASSERT_TRUE(result.has_value());
    double held = 0;
    for (const PanelChange& panel : result->panels) held += panel.ci_low_m2 <= 15 && 15 <= panel.ci_high_m2 ? 1 : 0;
    EXPECT_NEAR(held / 40000, 0.95, 0.005) << correlation;
  }
}

TEST(Comparison, TheIntervalOfTheSumHoldsItThoughAllPanelsShareAnError) {
  MonteCarlo world(0.8);
  const std::vector<double> before(60, 10), after(60, 12);
  int held = 0, trials = 4000;
  for (int t = 0; t < trials; ++t) {
    const auto result = compare_dates(world.measure(before, after, false), 0, 1, {.error_correlation = 0.8});
    ASSERT_TRUE(result.has_value());
    held += result->leaf_total.ci_low_m2 <= 120 && 120 <= result->leaf_total.ci_high_m2 ? 1 : 0;
  }
  EXPECT_NEAR(held / static_cast<double>(trials), 0.95, 0.012);  // three standard deviations are 1 %
}

TEST(RasterChange, IsTheDifferenceOfEveryCellThatBothDatesHave) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  RasterProduct a{"plan_density", "m2/m2", "density", Grid2<float>({10, 20}, 0.5, 2, 2)}, b = a;
  a.grid.values = {1, 2, nan, 0}, b.grid.values = {3, 1.5F, 4, nan};
  const auto change = raster_change(a, b);
  ASSERT_TRUE(change.has_value());
  EXPECT_EQ(change->name, "plan_density_change");
  EXPECT_EQ(change->grid.values[0], 2.0F);
  EXPECT_EQ(change->grid.values[1], -0.5F);
  EXPECT_TRUE(std::isnan(change->grid.values[2]));
  EXPECT_TRUE(std::isnan(change->grid.values[3]));
  EXPECT_EQ(change->grid.origin, a.grid.origin);

  RasterProduct shifted = b;
  shifted.grid.origin.x() += 0.5;
  EXPECT_EQ(raster_change(a, shifted).error().code, ErrorCode::usage);
  RasterProduct other = b;
  other.name = "canopy_height";
  EXPECT_EQ(raster_change(a, other).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::density
