#include "rayfield/experiments/turbid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::experiments {
namespace {

TEST(Turbid, SimulatedErrorsAgreeWithTheExactOnes) {
  TurbidOptions options;
  options.rays = {5, 20}, options.optical_depths = {0.3, 3}, options.trials = 40000;
  Progress progress;
  const auto result = run_turbid(options, progress);
  ASSERT_TRUE(result);
  ASSERT_EQ(result->cells.size(), 4U);
  for (const TurbidCell& cell : result->cells)
    for (std::size_t i = 0; i < kTurbidEstimators; ++i) {
      const Mean& mean = cell.simulated[i];
      EXPECT_GT(mean.standard_error, 0);
      EXPECT_NEAR(mean.value, cell.exact[i], 4.5 * mean.standard_error)
          << name_of(TurbidEstimator(i)) << ", n " << cell.rays << ", depth " << cell.optical_depth;
    }
}

TEST(Turbid, WithoutCensoringTheErrorAndItsSpreadAreThoseOfTheInverseGammaDistribution) {
  TurbidOptions options;
  options.rays = {10, 50}, options.optical_depths = {1}, options.trials = 40000;
  Progress progress;
  const auto result = run_turbid(options, progress);
  ASSERT_TRUE(result);
  for (const UncensoredCell& cell : result->uncensored) {
    EXPECT_NEAR(cell.maximum_likelihood.value, 1.0 / (cell.rays - 1), 4.5 * cell.maximum_likelihood.standard_error);
    EXPECT_NEAR(cell.debiased.value, 0, 4.5 * cell.debiased.standard_error);
    // Relative standard error of a standard deviation: √((κ − 1)/4N), with a kurtosis κ of 8 at n = 10 about 0.7 %.
    EXPECT_NEAR(cell.debiased_deviation * std::sqrt(cell.rays - 2.0), 1, 0.03);
    EXPECT_DOUBLE_EQ(cell.exact_deviation, 1 / std::sqrt(cell.rays - 2.0));
  }
}

TEST(Turbid, IsTheSameAtAnyNumberOfThreadsAndAnotherForAnotherSeed) {
  TurbidOptions options;
  options.rays = {3}, options.optical_depths = {1}, options.trials = 20000;
  Progress progress;
  options.threads = 1;
  const auto one = run_turbid(options, progress);
  options.threads = 3;
  const auto three = run_turbid(options, progress);
  options.seed = 2;
  const auto other = run_turbid(options, progress);
  ASSERT_TRUE(one && three && other);
  EXPECT_EQ(one->cells[0].simulated[1].value, three->cells[0].simulated[1].value);
  EXPECT_NE(one->cells[0].simulated[1].value, other->cells[0].simulated[1].value);
}

TEST(Turbid, RefusesWhatIsOutOfRange) {
  Progress progress;
  TurbidOptions one_ray;
  one_ray.rays = {1};
  EXPECT_EQ(run_turbid(one_ray, progress).error().where, "rays") << "its maximum likelihood has no mean";
  TurbidOptions no_trials;
  no_trials.trials = 0;
  EXPECT_EQ(run_turbid(no_trials, progress).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::experiments
