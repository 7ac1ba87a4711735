#include "libalign/evidence/evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rayfield::align {
namespace {

TEST(Evidence, DistancesBeyondThreeTimesTheMedianDoNotCountForTheSpread) {
  EXPECT_DOUBLE_EQ(trimmed_mean_square(std::vector<double>{1, 2, 2, 3, 7}), (1 + 4 + 4 + 9) / 4.0);
  EXPECT_DOUBLE_EQ(trimmed_mean_square(std::vector<double>{1, 2, 2, 3, 6}), (1 + 4 + 4 + 9 + 36) / 5.0);
  EXPECT_TRUE(std::isnan(trimmed_mean_square({})));
}

}  // namespace
}  // namespace rayfield::align
