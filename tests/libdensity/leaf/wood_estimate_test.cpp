#include "libdensity/leaf/wood_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "libdensity/integration/integrate.h"
#include "tests/libdensity/random_row.h"

namespace rayfield::density {
namespace {

/// Mean of exp(−½·(ln(W/m)/ln s)²)/W/√(P − W) over 0 < W < P, by a million even steps of W.
double mean_by_even_steps(double plants, double per_side, double spread) {
  constexpr int kSteps = 1'000'000;
  const auto weight = [&](double wood) {
    const double z = std::log(wood / per_side) / std::log(spread);
    return std::exp(-0.5 * z * z) / wood / std::sqrt(plants - wood);
  };
  double sum = 0, moment = 0;
  const auto wood_at = [&](int i) { return plants * (i + 0.5) / kSteps; };
  for (int i = 0; i < kSteps; ++i) sum += weight(wood_at(i)), moment += weight(wood_at(i)) * wood_at(i);
  return moment / sum;
}

TEST(WoodEstimate, UnderDenseLeavesIsWhatVineyardsHaveInGeneral) {
  // Of a log-normal distribution: mean m·exp(½·ln²s), 97.5 % quantile m·s^1.96.
  const ThinWood wood = believe_wood(1e4, {}, {.per_side = 0.18, .spread = 1.8});
  EXPECT_NEAR(wood.mean, 0.18 * std::exp(0.5 * std::pow(std::log(1.8), 2)), 1e-3 * wood.mean);
  EXPECT_NEAR(wood.most, 0.18 * std::pow(1.8, 1.959964), 1e-6);
}

TEST(WoodEstimate, OfWhatIsSeenFollowsItsFormula) {
  for (const double plants : {0.02, 0.1, 0.2, 0.5, 1.5, 4.0}) {
    const double expected = mean_by_even_steps(plants, 0.2, 2);
    EXPECT_NEAR(believe_wood(plants, {}, {.per_side = 0.2, .spread = 2}).mean, expected, 2e-3 * expected) << plants;
  }
}

TEST(WoodEstimate, MayBeAllThatIsSeenUpToWhatTheThickestVinesHave) {
  const double thickest = 0.2 * std::pow(2.0, 1.959964);
  const WoodPriorOptions options{.per_side = 0.2, .spread = 2};
  EXPECT_EQ(believe_wood(0.99 * thickest, {}, options).most, 0.99 * thickest);
  EXPECT_NEAR(believe_wood(1.5 * thickest, {}, options).most, thickest, 1e-6);
}

TEST(WoodEstimate, IsNeverMoreThanThePlantsAndLeavesGrowWithThem) {
  double before = 0;
  for (double plants = 1e-6; plants < 100; plants *= 1.3) {
    const ThinWood wood = believe_wood(plants, {}, {});
    EXPECT_GT(plants - wood.mean, before) << plants;
    EXPECT_GT(wood.most, wood.mean);
    EXPECT_LE(wood.most, plants);
    before = plants - wood.mean;
  }
  EXPECT_EQ(believe_wood(0, {}, {}).most, 0);
}

TEST(WoodEstimate, IsNoMoreThanTheBarestScanShows) {
  const WoodPriorOptions options{.per_side = 0.2, .spread = 2};
  const double thickest = 0.2 * std::pow(2.0, 1.959964);
  const ThinWood wood = believe_wood(4, ThinPlants{0.15, 0.25}, options);
  EXPECT_NEAR(wood.mean, mean_by_even_steps(0.15, 0.2, 2), 2e-3 * wood.mean) << "as if that were all there is";
  EXPECT_EQ(wood.most, 0.25) << "it may have shown too little";
  EXPECT_NEAR(believe_wood(4, ThinPlants{1, 3}, options).most, thickest, 1e-6);
  const ThinWood alone = believe_wood(0.3, {}, options), thinner = believe_wood(0.3, ThinPlants{0.5, 0.7}, options);
  EXPECT_EQ(thinner.mean, alone.mean) << "this panel shows less";
  EXPECT_EQ(thinner.most, alone.most);
  const ThinWood none = believe_wood(4, ThinPlants{0, 0.1}, options);
  EXPECT_EQ(none.mean, 0);
  EXPECT_EQ(none.most, 0.1);
}

TEST(WoodEstimate, ScalesWithTheUnitOfArea) {
  const ThinWood wood = believe_wood(0.6, {}, {.per_side = 0.2, .spread = 1.7});
  const ThinWood tenfold = believe_wood(6, {}, {.per_side = 2, .spread = 1.7});
  EXPECT_NEAR(tenfold.mean, 10 * wood.mean, 1e-9);
  EXPECT_NEAR(tenfold.most, 10 * wood.most, 1e-9);
}

struct TakenOut {
  std::vector<PanelValue> before, after;
  RowDensity leaf;
};

/// Of a row of random densities with two panels.
TakenOut take_out(bool second_has_value = true, const PanelPlants& barest = {}) {
  const RowDensity plant = testing::random_row(7);
  const double end_m = plant.n_along * plant.voxel_m;
  std::vector<Panel> panels = {{1, 1, 0, 0.4 * end_m}, {1, 2, 0.4 * end_m, end_m}};
  panels[0].identity.uid = "first", panels[1].identity.uid = "second";
  std::vector<PanelValue> values = integrate_panels(plant, panels, 2.5, {});
  if (!second_has_value) values[1].leaf_area_m2 = std::numeric_limits<double>::quiet_NaN();
  TakenOut out{values, values, {}};
  out.leaf = take_out_wood(plant, panels, barest, {}, out.after);
  return out;
}

double area_of(const RowDensity& row) {
  return std::accumulate(row.density.begin(), row.density.end(), 0.0) * std::pow(row.voxel_m, 3);
}

TEST(WoodEstimate, IsTakenOutOfVoxelsAndPanelsAlike) {
  const TakenOut t = take_out();
  double panels = 0;
  for (const PanelValue& value : t.after) panels += value.leaf_area_m2;
  EXPECT_NEAR(panels, area_of(t.leaf), 1e-5 * panels) << "a column at the border is shared by both";
  for (std::size_t k = 0; k < 2; ++k) {
    const PanelValue &plants = t.before[k], &leaves = t.after[k];
    const double wood = plants.leaf_area_m2 - leaves.leaf_area_m2, half = plants.ci_high_m2 - plants.leaf_area_m2;
    EXPECT_GT(wood, 0);
    EXPECT_EQ(leaves.plant_area_m2, plants.plant_area_m2);
    EXPECT_NEAR(leaves.lai / leaves.leaf_area_m2, plants.lai / plants.leaf_area_m2, 1e-12);
    EXPECT_NEAR(leaves.ci_high_m2 - leaves.leaf_area_m2, std::hypot(wood, half), 1e-12) << "there may be no wood";
    EXPECT_LT(leaves.ci_low_m2, leaves.leaf_area_m2 - half) << "and more than is expected";
    EXPECT_LT(leaves.se_leaf_area_m2, plants.se_leaf_area_m2);
  }
}

TEST(WoodEstimate, OfEachPanelIsBoundByWhatTheBarestScanShowsOfIt) {
  const TakenOut without = take_out();

  const double little = 0.01 * without.before[1].leaf_area_m2;
  const TakenOut with = take_out(true, {{"second", {little, 1.2 * little}}});
  EXPECT_EQ(with.after[0].leaf_area_m2, without.after[0].leaf_area_m2) << "not shown by it";
  EXPECT_GT(with.after[1].leaf_area_m2, 0.99 * with.before[1].leaf_area_m2);
  EXPECT_GT(with.after[1].ci_low_m2, without.after[1].ci_low_m2);
  EXPECT_GT(area_of(with.leaf), area_of(without.leaf));
}

TEST(WoodEstimate, APanelWithoutAValueKeepsNone) {
  const TakenOut t = take_out(false);
  EXPECT_TRUE(std::isnan(t.after[1].leaf_area_m2));
  const double share = 1 - t.after[0].leaf_area_m2 / t.before[0].leaf_area_m2;
  const RowDensity plant = testing::random_row(7);
  EXPECT_NEAR(area_of(t.leaf), (1 - share) * area_of(plant), 1e-5 * area_of(plant)) << "the row's share";
}

}  // namespace
}  // namespace rayfield::density
