#include "rayfield/experiments/moments.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::experiments {
namespace {

TEST(Moments, GiveMeanAndStandardErrorOfTheMean) {
  Moments moments;
  for (const double x : {1.0, 2.0, 3.0, 4.0}) moments.add(x);
  EXPECT_DOUBLE_EQ(moments.mean().value, 2.5);
  EXPECT_DOUBLE_EQ(moments.variance(), 5.0 / 3);
  EXPECT_DOUBLE_EQ(moments.mean().standard_error, std::sqrt(5.0 / 12));
}

TEST(Moments, OfOneTrialHaveNoErrorAndOfNoneNoMean) {
  Moments moments;
  EXPECT_EQ(moments.mean().value, 0);
  moments.add(7);
  EXPECT_EQ(moments.mean().value, 7);
  EXPECT_EQ(moments.mean().standard_error, 0);
}

TEST(Moments, OfTwoPartsAreThoseOfTheWhole) {
  Moments whole, first, second;
  for (const double x : {1.0, 5.0, 2.0}) whole.add(x), first.add(x);
  for (const double x : {-4.0, 8.0}) whole.add(x), second.add(x);
  first += second;
  EXPECT_EQ(first.count(), 5U);
  EXPECT_DOUBLE_EQ(first.mean().value, whole.mean().value);
  EXPECT_DOUBLE_EQ(first.mean().standard_error, whole.mean().standard_error);
}

TEST(NormalisedError, OfEstimatesThatAreATenthTooLargeIsATenthWithoutError) {
  NormalisedError error;
  for (const double truth : {1.0, 4.0, 2.5}) error.add(1.1 * truth, truth);
  EXPECT_NEAR(error.mean().value, 0.1, 1e-12);
  EXPECT_NEAR(error.mean().standard_error, 0, 1e-7);
}

// ⟨e⟩/⟨r⟩ weighs with r: (1 + 0)/(1 + 9) and not the mean of 1/1 and 0/9.
TEST(NormalisedError, IsThatOfTheMeansAndNotTheMeanOfErrors) {
  NormalisedError error;
  error.add(2, 1), error.add(9, 9);
  EXPECT_DOUBLE_EQ(error.mean().value, 0.1);
}

// Errors of ±1 on a truth of 2: the standard error of the mean error is √(n/(n − 1))/√n, over 2.
TEST(NormalisedError, HasTheStandardErrorOfTheMeanErrorWhereTheTruthIsConstant) {
  NormalisedError first, second;
  for (int i = 0; i < 50; ++i) (i < 20 ? first : second).add(i % 2 == 0 ? 3 : 1, 2);
  first += second;
  EXPECT_NEAR(first.mean().value, 0, 1e-12);
  EXPECT_NEAR(first.mean().standard_error, 0.5 / std::sqrt(49.0), 1e-12);
}

}  // namespace
}  // namespace rayfield::experiments
