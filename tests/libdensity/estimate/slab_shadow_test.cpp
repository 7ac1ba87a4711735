#include "libdensity/estimate/slab_shadow.h"

#include <gtest/gtest.h>

#include "tests/libdensity/hedge_run.h"

namespace rayfield::density {
namespace {

using testing::density_of;
using testing::Hedge;
using testing::HedgeOptions;
using testing::leaf_areas;
using testing::panels_of;
using testing::truth_of;

TEST(SlabShadow, IsNothingForInfinitesimalLeavesAndGrowsWithThem) {
  EXPECT_EQ(slab_shadow(0, 0.06), 0);
  EXPECT_EQ(slab_shadow(0.008, 0), 0);
  EXPECT_LT(slab_shadow(0.0001, 0.06), 0.001);
  EXPECT_LT(slab_shadow(0.0035, 0.06), slab_shadow(0.0070, 0.06));
  EXPECT_LT(slab_shadow(0.0070, 0.08), slab_shadow(0.0070, 0.06));
}

TEST(SlabShadow, DependsOnTheLeavesSideInVoxelsAlone) {
  EXPECT_NEAR(slab_shadow(0.0036, 0.06), slab_shadow(0.0144, 0.12), 1e-6);
}

TEST(SlabShadow, IsTakenOffThinHedgesOfLargeLeavesInSmallVoxels) {
  double small = 0, large = 0, truth = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    HedgeOptions options;
    options.length_m = 18, options.leaf_size_m2 = 0.0100, options.leaf_area_per_m = 0.5, options.seed = seed;
    options.sigma_across_m = 0.32, options.bottom_m = 0.7, options.top_m = 2.0;  // thin
    const Hedge hedge(options);
    const auto rays = hedge.scan({});
    const auto panels = panels_of(hedge, 3);
    EstimatorOptions estimator;
    estimator.leaf_size_m2 = options.leaf_size_m2;
    const auto true_areas = truth_of(hedge, panels);
    const auto in_small = leaf_areas(density_of(hedge, rays, 0.06, estimator), panels);
    const auto in_large = leaf_areas(density_of(hedge, rays, 0.12, estimator), panels);
    for (std::size_t i = 0; i < panels.size(); ++i) truth += true_areas[i], small += in_small[i], large += in_large[i];
  }
  const double shadow_small = slab_shadow(0.0100, 0.06), shadow_large = slab_shadow(0.0100, 0.12);
  EXPECT_GT(shadow_small, 0.04);
  EXPECT_LT(shadow_large, 0.02);
  EXPECT_NEAR(small / truth, 1, 0.03);
  EXPECT_NEAR(large / truth, 1, 0.03);
  EXPECT_NEAR(small / large, 1, 0.02);
}

}  // namespace
}  // namespace rayfield::density
