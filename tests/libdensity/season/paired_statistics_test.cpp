#include "libdensity/season/paired_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace rayfield::density {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Calculated by hand: differences 1 0 1 1; S_aa = 5, S_bb = 6.75, S_ab = 5.5; means 2.5 and 3.25.
const std::vector<double> kA = {1, 2, 3, 4}, kB = {2, 2, 4, 5};

void expect_by_hand(const PairedStatistics& s) {
  EXPECT_EQ(s.count, 4U);
  EXPECT_NEAR(s.mean_a, 2.5, 1e-12);
  EXPECT_NEAR(s.mean_b, 3.25, 1e-12);
  EXPECT_NEAR(s.rmse, std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(s.rrmse, std::sqrt(0.75) / 2.875, 1e-12);
  EXPECT_NEAR(s.slope, 1.1, 1e-12);
  EXPECT_NEAR(s.intercept, 0.5, 1e-12);
  EXPECT_NEAR(s.r_squared, 30.25 / 33.75, 1e-12);
  EXPECT_NEAR(s.orthogonal_slope, (1.75 + std::sqrt(124.0625)) / 11, 1e-12);
  EXPECT_NEAR(s.orthogonal_intercept, 3.25 - 2.5 * s.orthogonal_slope, 1e-12);
}

TEST(PairedStatistics, AreThoseCalculatedByHand) { expect_by_hand(paired_statistics(kA, kB)); }

TEST(PairedStatistics, PairsThatMissAValueAreLeftOut) {
  const std::vector<double> a = {1, kNaN, 2, 3, 9, 4}, b = {2, 7, 2, 4, kNaN, 5};
  expect_by_hand(paired_statistics(a, b));
}

TEST(PairedStatistics, OfEqualDatesAreAPerfectLine) {
  const PairedStatistics s = paired_statistics(kA, kA);
  EXPECT_EQ(s.rmse, 0);
  EXPECT_NEAR(s.slope, 1, 1e-12);
  EXPECT_NEAR(s.orthogonal_slope, 1, 1e-12);
  EXPECT_NEAR(s.intercept, 0, 1e-12);
  EXPECT_NEAR(s.r_squared, 1, 1e-12);
}

TEST(PairedStatistics, WhatCannotBeToldIsNan) {
  const PairedStatistics none = paired_statistics({}, {});
  EXPECT_EQ(none.count, 0U);
  EXPECT_TRUE(std::isnan(none.mean_a) && std::isnan(none.rrmse) && std::isnan(none.slope));

  const std::vector<double> three = {3}, five = {5};
  const PairedStatistics one = paired_statistics(three, five);
  EXPECT_EQ(one.rmse, 2);
  EXPECT_NEAR(one.rrmse, 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(one.slope) && std::isnan(one.orthogonal_slope) && std::isnan(one.r_squared));

  const std::vector<double> same = {3, 3, 3};
  const PairedStatistics flat = paired_statistics(same, std::vector<double>{1, 2, 3});
  EXPECT_TRUE(std::isnan(flat.slope) && std::isnan(flat.orthogonal_slope));

  // Without leaves the areas scatter around 0: a relative error means nothing.
  const PairedStatistics bare = paired_statistics(std::vector<double>{-0.1, 0.05}, std::vector<double>{0.02, -0.05});
  EXPECT_TRUE(std::isnan(bare.rrmse));
  EXPECT_GT(bare.rmse, 0);
}

TEST(PairedStatistics, TheOrthogonalLineKeepsItsSlopeWhereBothDatesHaveErrorsAndLeastSquaresFlattens) {
  std::mt19937_64 rng(7);
  std::normal_distribution<double> noise(0, 0.5), spread(4, 1);
  std::vector<double> a, b;
  for (int i = 0; i < 20000; ++i) {
    const double truth = spread(rng);
    a.push_back(truth + noise(rng)), b.push_back(truth + 1 + noise(rng));
  }
  const PairedStatistics s = paired_statistics(a, b);
  // The variance of a is 1 + 0.25, so least squares gives 1/1.25.
  EXPECT_NEAR(s.slope, 0.8, 0.02);
  EXPECT_NEAR(s.orthogonal_slope, 1, 0.03);
}

}  // namespace
}  // namespace rayfield::density
