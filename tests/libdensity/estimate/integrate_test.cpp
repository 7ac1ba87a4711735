#include "libdensity/estimate/integrate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "libdensity/estimate/plan_raster.h"
#include "tests/libdensity/voxel_worlds.h"

namespace rayfield::density {
namespace {

using testing::make_row_segment;

/// A row of two row segments with a bend of 3°, random densities, everything observed.
RowDensity random_row(std::uint64_t seed) {
  RowDensity r;
  r.row = 1;
  RowSegment a = make_row_segment(), b = a;
  a.chainage_m = 0;
  b.index = 1, b.first_along = a.n_along, b.chainage_m = a.n_along * a.voxel_m;
  b.origin = a.origin + b.chainage_m * a.direction;
  b.direction = Eigen::Rotation2Dd(0.05) * a.direction;
  r.row_segments = {a, b};
  r.voxel_m = a.voxel_m, r.n_across = a.n_across, r.n_up = a.n_up;
  r.across_min_m = a.across_min_m, r.up_min_m = a.up_min_m;
  for (int s = 0; s < 2; ++s)
    for (int i = 0; i < a.n_along; ++i) {
      r.segment_of.push_back(s);
      r.chainage_m.push_back((s * a.n_along + i) * a.voxel_m);
    }
  r.n_along = 2 * a.n_along;
  const auto voxels = static_cast<std::size_t>(r.n_along * r.n_across * r.n_up);
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<float> uniform(0, 8);
  for (std::size_t i = 0; i < voxels; ++i) r.density.push_back(uniform(rng)), r.variance.push_back(uniform(rng));
  r.state.assign(voxels, VoxelState::observed);
  r.entries.assign(r.segment_of.size(), 3);
  return r;
}

// A map that holds the row and nothing beyond.
Result<PlanRaster> raster_of(const RowDensity& row, const PlanRasterOptions& options) {
  Eigen::AlignedBox2d box;
  for (int a = 0; a < row.n_along; ++a)
    for (const int c : {0, row.n_across - 1}) {
      box.extend(Eigen::Vector2d(row.center(a, c).array() - row.voxel_m));
      box.extend(Eigen::Vector2d(row.center(a, c).array() + row.voxel_m));
    }
  RAYFIELD_ASSIGN(const RasterFrame frame, frame_around(box, options.cell_m));
  return PlanRaster::create(frame, row.row_segments, options);
}

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

TEST(Integrate, ThePlanRasterHoldsTheSameAreaAtAnyCellSize) {
  const RowDensity row = random_row(2);
  for (const double cell : {0.05, 0.1, 0.25, 1.0}) {
    auto raster = raster_of(row, {cell, 0.97});
    ASSERT_TRUE(raster.has_value());
    raster->add(row);
    const auto products = raster->finish();
    ASSERT_EQ(products[0].name, "plan_density");
    double sum = 0;
    for (const float v : products[0].grid.values)
      if (std::isfinite(v)) sum += static_cast<double>(v) * cell * cell;
    EXPECT_NEAR(sum, direct_sum(row), 1e-5 * sum) << cell;
    const Eigen::Vector2d steps = products[0].grid.origin / cell;
    EXPECT_NEAR(steps.x(), std::round(steps.x()), 1e-6);
    EXPECT_NEAR(steps.y(), std::round(steps.y()), 1e-6);
  }
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
  const double half = 1.959964 * std::hypot(v.se_leaf_area_m2, 0.025 * v.leaf_area_m2);
  EXPECT_NEAR(v.ci_high_m2 - v.leaf_area_m2, half, 1e-5);
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
  auto raster = raster_of(row, {});
  ASSERT_TRUE(raster.has_value());
  raster->add(row);
  const std::vector<RasterProduct> products = raster->finish();
  for (const RasterProduct& product : products)
    for (const float v : product.grid.values) EXPECT_TRUE(std::isnan(v));
}

TEST(Integrate, TheStandardErrorOfAMapCellAddsIndependentColumns) {
  RowDensity row = random_row(7);
  std::fill(row.variance.begin(), row.variance.end(), 0.0F);
  row.variance[row.index(4, 4, 3)] = 9.0F;
  auto raster = raster_of(row, {10.0, 0.97});  // cells larger than the row
  ASSERT_TRUE(raster.has_value());
  raster->add(row);
  double variance = 0;  // the column may lie across a border of cells: compare shares² only when it does not
  const std::vector<RasterProduct> products = raster->finish();
  for (const float v : products[1].grid.values)
    if (std::isfinite(v)) variance += std::pow(static_cast<double>(v) * 100.0, 2);
  const double expected = 9.0 * std::pow(0.12, 6);
  EXPECT_LE(variance, expected * 1.0001);
  EXPECT_GE(variance, expected * 0.25);
}

TEST(Integrate, OverlapOfASquareTurnedByFortyFiveDegreesIsExact) {
  // A unit diamond about the origin (diagonal √2): a quarter of it lies in the first quadrant's box.
  const double h = std::sqrt(0.5);
  const std::vector<Eigen::Vector2d> diamond = {{h, 0}, {0, h}, {-h, 0}, {0, -h}};
  EXPECT_NEAR(overlap_area(diamond, {0, 0}, {1, 1}), 0.25, 1e-12);
  EXPECT_NEAR(overlap_area(diamond, {-2, -2}, {2, 2}), 1.0, 1e-12);
  EXPECT_NEAR(overlap_area(diamond, {0.5, -1}, {1, 1}), (h - 0.5) * (h - 0.5), 1e-12);
  EXPECT_EQ(overlap_area(diamond, {1, 1}, {2, 2}), 0);
}

TEST(Integrate, QuantileHeightsAreLinearInsideALayer) {
  const std::vector<double> layers = {0, 2, 2, 0};
  EXPECT_NEAR(quantile_height(layers, 0.1, 0.5), 0.2, 1e-12);
  EXPECT_NEAR(quantile_height(layers, 0.1, 0.75), 0.25, 1e-12);
  EXPECT_NEAR(quantile_height(layers, 0.1, 1.0), 0.3, 1e-12);
  EXPECT_TRUE(std::isnan(quantile_height(std::vector<double>{0, 0}, 0.1, 0.5)));
}

TEST(PlanRaster, NoRowSegmentsAndOptionsOutOfRangeAreRefused) {
  const RowDensity row = random_row(1);
  const RasterFrame frame{row.row_segments[0].origin - Eigen::Vector2d(64, 64), 0.1, 1280, 1280};
  EXPECT_EQ(PlanRaster::create(frame, {}, {}).error().code, ErrorCode::usage);
  EXPECT_FALSE(PlanRaster::create(frame, row.row_segments, {0.0, 0.97}).has_value());
  EXPECT_TRUE(PlanRaster::create(frame, row.row_segments, {}).has_value());
}

TEST(PlanRaster, ARowThatReachesBeyondTheFrameIsRefusedInsteadOfCut) {
  const RowDensity row = random_row(1);
  const RasterFrame frame{row.row_segments[0].origin, 0.1, 64, 64};
  EXPECT_EQ(PlanRaster::create(frame, row.row_segments, {}).error().code, ErrorCode::internal);
}

}  // namespace
}  // namespace rayfield::density
