#include "rayfield/experiments/triangles.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::experiments {
namespace {

TriangleOptions small_options() {
  TriangleOptions options;
  options.configurations = {{0.05, 0.01}}, options.most_rays = 4;
  options.sides_m = {0.01}, options.areas_m2 = {0.006}, options.surface_rays = 10;
  options.trials = 3000;
  return options;
}

// Leaves of 1 cm in a voxel of 10 cm are nearly a Poisson medium: two of ten rays seldom meet one leaf. The share of a
// voxel's rays that another ray's leaf takes is about its shadow over the voxel's, ½·0.43 cm²/100 cm² · 10 rays = 2 %.
TEST(Triangles, OfSmallLeavesAreReadWithoutBiasByTheUnbiasedEstimator) {
  Progress progress;
  const auto result = run_triangles(small_options(), progress);
  ASSERT_TRUE(result);
  ASSERT_EQ(result->surface.size(), 1U);
  const TriangleCell& cell = result->surface[0];
  EXPECT_NEAR(cell.unbiased.value, 0, 0.02 + 4.5 * cell.unbiased.standard_error);
  EXPECT_NEAR(cell.leaves_in_voxel, 0.006 / (std::sqrt(3.0) / 4 * 1e-4), 1e-9);
}

TEST(Triangles, DebiasingTakesTheSameShareFromEveryEstimate) {
  Progress progress;
  const auto result = run_triangles(small_options(), progress);
  ASSERT_TRUE(result);
  ASSERT_EQ(result->few_rays.size(), 3U);
  for (const TriangleCell& cell : result->few_rays) {
    const double n = cell.rays;
    EXPECT_NEAR(1 + cell.debiased.value, (n - 1) / n * (1 + cell.maximum_likelihood.value), 1e-9);
    EXPECT_GT(cell.maximum_likelihood.value, cell.unbiased.value);
  }
}

TEST(Triangles, AreTheSameAtAnyNumberOfThreads) {
  TriangleOptions options = small_options();
  options.trials = 500;
  Progress progress;
  options.threads = 1;
  const auto one = run_triangles(options, progress);
  options.threads = 3;
  const auto three = run_triangles(options, progress);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->surface[0].debiased.value, three->surface[0].debiased.value);
}

TEST(Triangles, RefuseWhatIsOutOfRange) {
  Progress progress;
  TriangleOptions options = small_options();
  options.areas_m2 = {-1};
  EXPECT_EQ(run_triangles(options, progress).error().where, "areas_m2");
}

}  // namespace
}  // namespace rayfield::experiments
