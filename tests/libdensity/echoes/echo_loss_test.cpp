#include "libdensity/echoes/echo_loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayfield::density {
namespace {

/// Share of a disc of diameter 1 that a straight edge covers, x from its centre.
double covered(double x) { return (std::acos(2 * x) - 2 * x * std::sqrt(1 - 4 * x * x)) / std::numbers::pi; }

/// Energy that the edge of a large leaf takes in pieces below the share t, per length of edge and diameter.
double lost_at_edges(double t) {
  double lost = 0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double share = covered((i + 0.5) / kSteps * 0.5);
    if (share < t) lost += share * 0.5 / kSteps;
  }
  return lost;
}

TEST(EchoLoss, ThinBeamsLoseNothing) {
  for (const double share : {0.05, 0.25, 0.5})
    for (const double depth : {0.0, 1.0, 4.0}) EXPECT_EQ(returned_share(0, share, depth), 1);
  EXPECT_EQ(mean_echo_share(0, 0.3), 1);
}

// Shadows of square leaves of side s have a perimeter of π·s in the mean and an area of s²/2: 2π·s over it. In thin
// canopy that is all; at a fifth of a side corners and other leaves begin to matter.
TEST(EchoLoss, NarrowBeamsLoseWhatEdgesTake) {
  for (const double share : {0.15, 0.25, 0.40}) {
    const double per_width = 2 * std::numbers::pi * lost_at_edges(share);
    EXPECT_NEAR(returned_share(0.1, share, 0), 1 - 0.1 * per_width, 0.01) << share;
    EXPECT_NEAR(returned_share(0.2, share, 0), 1 - 0.2 * per_width, 0.02) << share;
  }
}

TEST(EchoLoss, MoreIsLostOfWiderBeamsAndAtHigherShares) {
  for (double width = 0.1; width < 1.2; width += 0.1) {
    EXPECT_LT(returned_share(width + 0.1, 0.25, 0), returned_share(width, 0.25, 0)) << width;
    EXPECT_LT(mean_echo_share(width, 0.25), 1);
    for (double share = 0.05; share < 0.45; share += 0.05)
      EXPECT_LT(returned_share(width, share + 0.05, 0.5), returned_share(width, share, 0.5)) << width << " " << share;
  }
}

TEST(EchoLoss, BeyondTheTableItsEndsHold) {
  EXPECT_EQ(returned_share(5, 0.25, 1), returned_share(1.3, 0.25, 1));
  EXPECT_EQ(returned_share(0.3, 0.9, 1), returned_share(0.3, 0.5, 1));
  EXPECT_EQ(returned_share(0.3, 0.25, 99), returned_share(0.3, 0.25, 2.5));
  EXPECT_EQ(mean_echo_share(0.3, 0), mean_echo_share(0.3, 0.05));
}

}  // namespace
}  // namespace rayfield::density
