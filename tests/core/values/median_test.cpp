#include "rayfield/core/median.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield {
namespace {

TEST(Median, IsTheMiddleValueAndOfAnEvenNumberTheLargerOfTheTwoInTheMiddle) {
  EXPECT_EQ(median_of({3.0, -1.0, 2.0}), 2);
  EXPECT_EQ(median_of({4.0, 1.0, 3.0, 2.0}), 3);
  EXPECT_EQ(median_of({5.0}), 5);
  EXPECT_EQ(median_of({1.0, 1.0, 9.0, 1.0}), 1);
}

TEST(Median, OfNoValuesIsWhatTheCallerSays) {
  EXPECT_TRUE(std::isnan(median_of({})));
  EXPECT_EQ(median_of({}, 1.8), 1.8);
}

TEST(Median, LeavesTheCallersValuesInTheirOrder) {
  const std::vector<double> values = {3, 1, 2};
  EXPECT_EQ(median_of(values), 2);
  EXPECT_EQ(values, (std::vector<double>{3, 1, 2}));
}

}  // namespace
}  // namespace rayfield
