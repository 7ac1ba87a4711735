#include "experiments/trials/trials.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "rayfield/experiments/moments.h"

namespace rayfield::experiments {
namespace {

Result<Moments> sum_logarithms(std::uint64_t count, int threads) {
  Progress progress;
  return sum_over_trials<Moments>(count, 10, threads, {}, progress,
                                  [](std::uint64_t trial, Moments& sums) -> Result<void> {
                                    sums.add(std::log(trial_random(1, 2, trial).uniform()));
                                    return {};
                                  });
}

TEST(Trials, EachIsRunOnceAndTheSumIsTheSameAtAnyNumberOfThreads) {
  const auto one = sum_logarithms(1003, 1), three = sum_logarithms(1003, 3);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->count(), 1003U);
  EXPECT_EQ(one->mean().value, three->mean().value) << "bit by bit";
  EXPECT_EQ(one->mean().standard_error, three->mean().standard_error);
}

TEST(Trials, OfDifferentSeedsCellsAndNumbersHaveDifferentRandomNumbers) {
  const std::uint64_t bits = trial_random(1, 2, 3).bits();
  EXPECT_EQ(trial_random(1, 2, 3).bits(), bits);
  EXPECT_NE(trial_random(2, 2, 3).bits(), bits);
  EXPECT_NE(trial_random(1, 3, 3).bits(), bits);
  EXPECT_NE(trial_random(1, 2, 4).bits(), bits);
}

TEST(Trials, StopWhenTheUserAsksTo) {
  struct Stopped : Progress {
    bool cancelled() const override { return true; }
  } progress;
  const auto sums =
      sum_over_trials<Moments>(5, 1, 1, {}, progress, [](std::uint64_t, Moments&) -> Result<void> { return {}; });
  ASSERT_FALSE(sums);
  EXPECT_EQ(sums.error().code, ErrorCode::interrupted);
}

TEST(Trials, GiveTheErrorOfATrial) {
  Progress progress;
  const auto sums =
      sum_over_trials<Moments>(100, 10, 2, {}, progress, [](std::uint64_t trial, Moments&) -> Result<void> {
        if (trial >= 40) return fail(ErrorCode::resources, "cannot try", std::to_string(trial), "no");
        return {};
      });
  ASSERT_FALSE(sums);
  EXPECT_EQ(sums.error().where, "40") << "the first one";
}

TEST(Trials, RangesRefuseWhatIsOutsideAndNoValues) {
  EXPECT_TRUE(check_range("x", 1, 1, 2));
  EXPECT_EQ(check_range("x", 2.5, 1, 2).error().code, ErrorCode::usage);
  EXPECT_EQ(check_range("x", std::nan(""), 1, 2).error().where, "x");
  EXPECT_FALSE(check_ranges("x", {}, 1, 2));
  EXPECT_FALSE(check_ranges("x", {1, 3}, 1, 2));
}

}  // namespace
}  // namespace rayfield::experiments
