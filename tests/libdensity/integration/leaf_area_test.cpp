#include "libdensity/integration/leaf_area.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "libdensity/integration/integrate.h"
#include "libdensity/integration/plan_raster.h"
#include "libdensity/integration/raster_frame.h"
#include "tests/libdensity/plan_values.h"
#include "tests/libdensity/voxel_worlds.h"

namespace rayfield::density {
namespace {

using testing::make_row_segment;

/// One row segment, everything observed, densities around `mean` with noise of variance 1.
RowDensity noisy_row(double mean, std::uint64_t seed) {
  RowDensity r;
  const RowSegment s = make_row_segment();
  r.row = 1, r.row_segments = {s};
  r.voxel_m = s.voxel_m, r.n_along = s.n_along, r.n_across = s.n_across, r.n_up = s.n_up;
  r.across_min_m = s.across_min_m, r.up_min_m = s.up_min_m;
  for (int a = 0; a < s.n_along; ++a) r.segment_of.push_back(0), r.chainage_m.push_back(a * s.voxel_m);
  r.entries.assign(r.segment_of.size(), 3);
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> noise(mean, 1);
  for (std::size_t i = 0; i < r.shape().size(); ++i) r.density.push_back(static_cast<float>(noise(rng)));
  r.variance.assign(r.shape().size(), 1.0F);
  r.state.assign(r.shape().size(), VoxelState::observed);
  return r;
}

double sum_of(const RowDensity& r) {
  return std::accumulate(r.density.begin(), r.density.end(), 0.0) * std::pow(r.voxel_m, 3);
}

std::vector<Panel> two_panels() { return {{1, 1, 0, 1.1}, {1, 2, 1.1, 2.4}}; }

TEST(LeafArea, IsTheDifferenceOfTheSumsWhateverTheNoiseInTheVoxels) {
  const RowDensity plant = noisy_row(5, 1), wood = noisy_row(4, 2);
  const auto leaf = subtract_wood(plant, wood);
  ASSERT_TRUE(leaf);
  double area = 0, of_wood = 0;
  for (const LeafSum& sum : leaf_of_panels(*leaf, wood, two_panels())) area += sum.leaf_m2, of_wood += sum.wood_m2;
  EXPECT_NEAR(area, sum_of(plant) - sum_of(wood), 1e-5 * sum_of(plant));
  EXPECT_NEAR(of_wood, sum_of(wood), 1e-5 * sum_of(wood));
  const std::size_t below = std::count_if(leaf->density.begin(), leaf->density.end(), [](float d) { return d < 0; });
  EXPECT_GT(below, leaf->density.size() / 10) << "noise of two voxels is as large as their difference";
}

TEST(LeafArea, OfTwoScansOfBareWoodIsZeroWithinItsError) {
  int held = 0;
  double total = 0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    const RowDensity wood = noisy_row(4, 1000 + run);
    const auto leaf = subtract_wood(noisy_row(4, run), wood);
    const LeafSum sum = leaf_of_panels(*leaf, wood, two_panels())[0];
    total += sum.leaf_m2 / std::sqrt(sum.variance_m4);
    PanelValue value;
    value.plant_area_m2 = 1;
    set_leaf_area(value, sum, 1.1, 2.5, {}, {.wood_error = 0});
    if (value.ci_low_m2 <= 0 && value.ci_high_m2 >= 0) ++held;
  }
  EXPECT_NEAR(total / kRuns, 0, 3 / std::sqrt(kRuns)) << "no bias in units of the standard error";
  // An upper end below 0 is cut to 0, which then is held: only estimates too high by 1.96 standard errors miss.
  EXPECT_NEAR(held, 0.975 * kRuns, 3 * std::sqrt(0.975 * 0.025 * kRuns));
}

TEST(LeafArea, CountsOnlyWhatBothScansSaw) {
  RowDensity plant = noisy_row(5, 3), wood = noisy_row(2, 4);
  // The second panel's columns beyond 1.8 m were seen by the leafy scan alone, those below 0.24 m by the dormant one.
  for (int a = 0; a < plant.n_along; ++a)
    for (int c = 0; c < plant.n_across; ++c)
      for (int u = 0; u < plant.n_up; ++u) {
        if (a >= 15) wood.state[wood.index(a, c, u)] = VoxelState::unobserved;
        if (a < 2) plant.state[plant.index(a, c, u)] = VoxelState::unobserved;
      }
  const auto leaf = subtract_wood(plant, wood);
  double expected = 0;
  for (int a = 2; a < 15; ++a)
    for (int c = 0; c < plant.n_across; ++c)
      for (int u = 0; u < plant.n_up; ++u) expected += plant.canopy_area(a, c, u) - wood.canopy_area(a, c, u);
  const std::vector<Panel> whole = {{1, 1, 0, 2.4}};
  const LeafSum sum = leaf_of_panels(*leaf, wood, whole)[0];
  EXPECT_NEAR(sum.leaf_m2, expected, 1e-5 * expected);
  EXPECT_NEAR(sum.observed_fraction, 13.0 / 20, 1e-9);
  const std::vector<double> metres = leaf_of_metres(*leaf, 2.4, 0.48);
  ASSERT_EQ(metres.size(), 5U);
  EXPECT_TRUE(std::isfinite(metres[0]));
  EXPECT_TRUE(std::isnan(metres[4])) << "nobody saw the wood there";
}

TEST(LeafArea, OfHalfMetresAddsUpToThatOfThePanels) {
  const RowDensity wood = noisy_row(1, 6);
  const auto leaf = subtract_wood(noisy_row(4, 5), wood);
  double panels = 0, metres = 0;
  for (const LeafSum& sum : leaf_of_panels(*leaf, wood, two_panels())) panels += sum.leaf_m2;
  for (const double area : leaf_of_metres(*leaf, 2.4, 0.5)) metres += 0.5 * area;
  EXPECT_NEAR(metres, panels, 1e-9 * panels);
  const RasterFrame frame{leaf->row_segments[0].origin - Eigen::Vector2d(64, 64), 0.1, 1280, 1280};
  auto raster = PlanRaster::create(frame, leaf->row_segments, {}, testing::kAllInMemory, testing::scratch());
  ASSERT_TRUE(raster->add(*leaf).has_value());
  double map = 0;
  for (const float v : testing::values_of(*raster, 0))
    if (std::isfinite(v)) map += static_cast<double>(v) * 0.01;
  EXPECT_NEAR(map, panels, 1e-5 * panels);
}

TEST(LeafArea, LeavesOutMaskedWoodWhichBothScansLeaveOut) {
  RowDensity plant = noisy_row(5, 7), wood = noisy_row(2, 8);
  const double bare = subtract_wood(plant, wood)->canopy_area(3, 3, 3);
  for (RowDensity* row : {&plant, &wood}) {
    row->wood_area.assign(row->shape().size(), 0.5F);
    row->free_share.assign(row->shape().columns(), 0.75F);
  }
  const auto leaf = subtract_wood(plant, wood);
  EXPECT_NEAR(leaf->canopy_area(3, 3, 3), 0.75 * bare, 1e-9);
  EXPECT_NEAR(leaf->plant_area(3, 3, 3), 0.75 * bare, 1e-9);
}

TEST(LeafArea, CountsHowElementsAreTurnedForTheLeavesAndNotForTheWoodOfBothScans) {
  constexpr double kLeaf = 0.005, kVolume = 0.12 * 0.12 * 0.12;
  RowDensity plant = noisy_row(5, 11), wood = noisy_row(2, 12);
  for (RowDensity* row : {&plant, &wood}) {
    row->leaf_size_m2 = kLeaf;
    for (std::size_t i = 0; i < row->density.size(); ++i)
      row->density[i] = std::max(0.0F, row->density[i]),
      row->variance[i] = 1.0F + row->density[i] * static_cast<float>(kLeaf / kVolume / 3);
  }
  const auto leaf = subtract_wood(plant, wood);
  const std::vector<Panel> whole = {{1, 1, 0, 2.4}};
  const LeafSum sum = leaf_of_panels(*leaf, wood, whole)[0];
  const double sampling = 2.0 * static_cast<double>(leaf->shape().size()) * kVolume * kVolume;
  EXPECT_NEAR(sum.variance_m4, sampling + kLeaf * sum.leaf_m2 / 3, 1e-4 * sum.variance_m4);
}

TEST(LeafArea, OfAPanelSeenTooLittleIsUndefined) {
  PanelValue value;
  value.plant_area_m2 = 3, value.leaf_area_m2 = 2;
  set_leaf_area(value, {1.5, 0.5, 0.01, 0.49}, 4, 2.5, {}, {});
  for (const double v : {value.leaf_area_m2, value.leaf_area_per_m, value.lai, value.se_leaf_area_m2, value.ci_low_m2})
    EXPECT_TRUE(std::isnan(v));
  EXPECT_EQ(value.plant_area_m2, 3) << "its plants are known as before";
}

TEST(LeafArea, HasAnIntervalOfSamplingAndWhatIsShared) {
  PanelValue value;
  value.plant_area_m2 = 3;
  set_leaf_area(value, {2.0, 1.0, 0.01, 0.9}, 4, 2.5, {}, {.wood_error = 0.1});
  EXPECT_EQ(value.leaf_area_m2, 2);
  EXPECT_EQ(value.leaf_area_per_m, 0.5);
  EXPECT_EQ(value.lai, 0.2);
  EXPECT_NEAR(value.se_leaf_area_m2, 0.1, 1e-12);
  const double factor = std::exp(1.959964 * 0.025), sampling = 1.959964 * std::sqrt(0.01 + 0.1 * 0.1);
  EXPECT_NEAR(value.ci_low_m2, 2 - std::hypot(sampling, 2 * (1 - 1 / factor)), 1e-6);
  EXPECT_NEAR(value.ci_high_m2, 2 + std::hypot(sampling, 2 * (factor - 1)), 1e-6);
  set_leaf_area(value, {-0.05, 1.0, 0.01, 0.9}, 4, 2.5, {}, {.wood_error = 0});
  EXPECT_EQ(value.leaf_area_m2, -0.05) << "not cut: means over panels stay right";
  EXPECT_EQ(value.ci_low_m2, 0);
  EXPECT_NEAR(value.ci_high_m2, 0.146, 1e-4);
}

TEST(LeafArea, OfAScanLessItselfIsExactlyZeroAndAsUncertainAsThatOfAnotherDrive) {
  const RowDensity wood = noisy_row(4, 10);
  const auto leaf = subtract_wood(wood, wood);
  for (const LeafSum& sum : leaf_of_panels(*leaf, wood, two_panels())) {
    EXPECT_EQ(sum.leaf_m2, 0);
    EXPECT_GT(sum.wood_m2, 0);
    EXPECT_GT(sum.variance_m4, 0);
    EXPECT_EQ(sum.observed_fraction, 1);
  }
}

TEST(LeafArea, IsRefusedForGridsThatDiffer) {
  RowDensity wood = noisy_row(1, 9);
  wood.up_min_m += 0.12;
  EXPECT_EQ(subtract_wood(noisy_row(1, 9), wood).error().code, ErrorCode::internal);
}

}  // namespace
}  // namespace rayfield::density
