#include "libdensity/integration/integrate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "tests/libdensity/random_row.h"

namespace rayfield::density {
namespace {

using testing::random_row;

double direct_sum(const RowDensity& r) {
  return std::accumulate(r.density.begin(), r.density.end(), 0.0) * std::pow(r.voxel_m, 3);
}

std::vector<Panel> two_panels() { return {{1, 1, 0.5, 2.03}, {1, 2, 2.03, 4.3}}; }

TEST(Integrate, ThePanelsTogetherAreTheWholeRowWithWhatOverhangsItsEnds) {
  const RowDensity row = random_row(1);
  double plant = 0;
  std::int64_t rays = 0;
  for (const PanelValue& v : integrate_panels(row, two_panels(), 2.5, {}))
    plant += v.plant_area_m2, rays += v.ray_count;
  EXPECT_NEAR(plant, direct_sum(row), 1e-6 * plant);
  EXPECT_NEAR(static_cast<double>(rays), 3.0 * row.n_along, 1);
}

TEST(Integrate, HalfMetresAddUpToTheRow) {
  const RowDensity row = random_row(3);
  double plant = 0;
  for (const RowMetreProduct& m : row_metres(row, 4.5, {})) plant += m.plant_area_per_m * 0.5;
  EXPECT_NEAR(plant, direct_sum(row), 1e-6 * plant);
}

TEST(Integrate, SectionsAddUpToTheRow) {
  const RowDensity row = random_row(4);
  double side = 0, end = 0;
  const SectionProduct from_side = side_view(row), from_end = end_on_section(row, 4.8);
  for (const float v : from_side.grid.values) side += static_cast<double>(v) * row.voxel_m * row.voxel_m;
  for (const float v : from_end.grid.values) end += static_cast<double>(v) * row.voxel_m * row.voxel_m * 4.8;
  EXPECT_NEAR(side, direct_sum(row), 1e-5 * side);
  EXPECT_NEAR(end, direct_sum(row), 1e-5 * end);
}

TEST(Integrate, AUniformSlabHasTheClosedFormsOfLaiHeightWidthAndGap) {
  RowDensity row = random_row(5);
  // Layers 2…5 and across 3…6 filled with 4 m²/m³, the rest empty: 0.48 m thick, 0.48 m high.
  for (int a = 0; a < row.n_along; ++a)
    for (int c = 0; c < row.n_across; ++c)
      for (int u = 0; u < row.n_up; ++u) {
        const bool in = u >= 2 && u < 6 && c >= 3 && c < 7;
        row.density[row.index(a, c, u)] = in ? 4.0F : 0.0F;
        row.variance[row.index(a, c, u)] = in ? 1.0F : 0.0F;
      }
  const double length = row.n_along * 0.12;
  const std::vector<Panel> whole = {{1, 1, 0, length}};
  const PanelValue v = integrate_panels(row, whole, 2.5, {})[0];
  EXPECT_NEAR(v.leaf_area_m2, 4 * 0.48 * 0.48 * length, 1e-5);
  EXPECT_NEAR(v.lai, v.leaf_area_m2 / (length * 2.5), 1e-9);
  EXPECT_NEAR(v.leaf_area_per_m, 4 * 0.48 * 0.48, 1e-5);
  EXPECT_NEAR(v.canopy_height_m, 0.3 + 0.24 + 0.97 * 0.48, 1e-5);
  EXPECT_NEAR(v.canopy_width_m, 0.96 * 0.48, 1e-5);
  EXPECT_NEAR(v.gap_fraction, std::exp(-0.5 * 4 * 0.48), 1e-5);
  EXPECT_NEAR(v.se_leaf_area_m2, std::sqrt(16.0 * row.n_along) * std::pow(0.12, 3), 1e-6);
  const double factor = std::exp(1.959964 * 0.025), sampling = 1.959964 * v.se_leaf_area_m2;
  EXPECT_NEAR(v.ci_high_m2, v.leaf_area_m2 + std::hypot(sampling, v.leaf_area_m2 * (factor - 1)), 1e-5);
  EXPECT_NEAR(v.ci_low_m2, v.leaf_area_m2 - std::hypot(sampling, v.leaf_area_m2 * (1 - 1 / factor)), 1e-5);
  EXPECT_EQ(v.observed_fraction, 1);
}

TEST(Integrate, UnscannedIsNanAndScannedEmptyIsZero) {
  RowDensity row = random_row(6);
  std::fill(row.density.begin(), row.density.end(), 0.0F);
  const auto empty = integrate_panels(row, two_panels(), 2.5, {});
  EXPECT_EQ(empty[0].plant_area_m2, 0);
  EXPECT_EQ(empty[0].gap_fraction, 1);
  std::fill(row.state.begin(), row.state.end(), VoxelState::unobserved);
  const auto unseen = integrate_panels(row, two_panels(), 2.5, {});
  EXPECT_TRUE(std::isnan(unseen[0].plant_area_m2));
  EXPECT_EQ(unseen[0].observed_fraction, 0);
  EXPECT_TRUE(std::isnan(row_metres(row, 4.5, {})[0].leaf_area_per_m));
}

TEST(Integrate, QuantileHeightsAreLinearInsideALayer) {
  const std::vector<double> layers = {0, 2, 2, 0};
  EXPECT_NEAR(quantile_height(layers, 0.1, 0.5), 0.2, 1e-12);
  EXPECT_NEAR(quantile_height(layers, 0.1, 0.75), 0.25, 1e-12);
  EXPECT_NEAR(quantile_height(layers, 0.1, 1.0), 0.3, 1e-12);
  EXPECT_TRUE(std::isnan(quantile_height(std::vector<double>{0, 0}, 0.1, 0.5)));
}

}  // namespace
}  // namespace rayfield::density
