#include "libdensity/integration/interval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rayfield::density {
namespace {

TEST(Interval, IsThatOfTheSamplingWhereNothingIsShared) {
  const Reach reach = reach_of(3, 0.04, 0);
  EXPECT_NEAR(reach.below, kNormal95 * 0.2, 1e-12);
  EXPECT_NEAR(reach.above, kNormal95 * 0.2, 1e-12);
}

TEST(Interval, OfASharedErrorIsAFactorEitherWay) {
  const Reach reach = reach_of(3, 0, 0.6);
  EXPECT_NEAR((3 + reach.above) / 3, 3 / (3 - reach.below), 1e-12);
  EXPECT_NEAR((3 + reach.above) / 3, std::exp(kNormal95 * 0.6), 1e-12);
}

TEST(Interval, OfSmallErrorsIsThatOfTheirSquares) {
  const Reach reach = reach_of(3, 0.0004, 0.005);
  const double half = kNormal95 * std::hypot(0.02, 0.005 * 3);
  EXPECT_NEAR(reach.below, half, 0.005 * half);
  EXPECT_NEAR(reach.above, half, 0.005 * half);
}

TEST(Interval, HoldsATrueAreaThatIsReadByAFactorOff) {
  int held = 0;
  constexpr int kRuns = 4000;
  std::mt19937 generator(1);
  std::normal_distribution<double> logarithm(0, 0.5);
  for (int run = 0; run < kRuns; ++run) {
    const double read = 2 * std::exp(logarithm(generator));
    const Reach reach = reach_of(read, 0, 0.5);
    held += read - reach.below <= 2 && 2 <= read + reach.above ? 1 : 0;
  }
  EXPECT_NEAR(held, 0.95 * kRuns, 3 * std::sqrt(0.95 * 0.05 * kRuns));
}

TEST(Interval, OfANegativeDifferenceHasPositiveReach) {
  const Reach reach = reach_of(-0.2, 0.01, 0.1);
  EXPECT_GT(reach.below, 0.19);
  EXPECT_GT(reach.above, reach.below);
}

}  // namespace
}  // namespace rayfield::density
