#include "libdensity/zones/natural_breaks.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace rayfield::density {
namespace {

std::vector<double> ones(std::size_t count) { return std::vector<double>(count, 1.0); }

// Sum of squared deviations from their mean of values between two bounds.
double deviation(const std::vector<double>& values, double low, double high) {
  double sum = 0, squares = 0, count = 0;
  for (const double v : values)
    if (v >= low && v < high) sum += v, squares += v * v, ++count;
  return count > 0 ? squares - sum * sum / count : 0;
}

TEST(NaturalBreaks, FindsTheGapsBetweenThreeGroups) {
  const std::vector<double> values = {1.0, 1.1, 1.2, 4.0, 4.1, 4.2, 9.0, 9.1, 9.2};
  const auto found = natural_breaks(values, ones(values.size()), 3);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 2U);
  EXPECT_NEAR((*found)[0], 2.6, 1e-9);
  EXPECT_NEAR((*found)[1], 6.6, 1e-9);
}

TEST(NaturalBreaks, NoOtherTwoCutsLeaveLessVariance) {
  std::mt19937 random(3);
  std::vector<double> values;
  for (int i = 0; i < 60; ++i) values.push_back(static_cast<double>(random() % 1000) / 1000);
  const auto found = natural_breaks(values, ones(values.size()), 3);
  ASSERT_TRUE(found);
  const auto inside = [&](double a, double b) {
    return deviation(values, -1, a) + deviation(values, a, b) + deviation(values, b, 2);
  };
  double best = std::numeric_limits<double>::infinity();
  for (const double a : values)
    for (const double b : values)
      if (a < b) best = std::min(best, inside(a, b));
  EXPECT_NEAR(inside((*found)[0], (*found)[1]), best, 1e-9);
}

TEST(NaturalBreaks, WeightsCountAsRepetitions) {
  const std::vector<double> values = {0, 1, 5, 6, 7};
  const std::vector<double> weights = {3, 1, 2, 1, 4};
  std::vector<double> repeated;
  for (std::size_t i = 0; i < values.size(); ++i)
    repeated.insert(repeated.end(), static_cast<std::size_t>(weights[i]), values[i]);
  const auto a = natural_breaks(values, weights, 2), b = natural_breaks(repeated, ones(repeated.size()), 2);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(*a, *b);
}

TEST(NaturalBreaks, TooFewDifferentValuesAreRefused) {
  const std::vector<double> values = {2, 2, 2, 3};
  const auto found = natural_breaks(values, ones(4), 3);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::bad_input);
  EXPECT_FALSE(natural_breaks({}, {}, 2));
}

}  // namespace
}  // namespace rayfield::density
