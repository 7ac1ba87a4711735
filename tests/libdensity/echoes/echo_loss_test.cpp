#include "libdensity/echoes/echo_loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayfield::density {
namespace {

constexpr double kThinCanopy = 0;  // optical path of a range resolution

/// Share of a disc of diameter 1 that a straight edge covers, x from its centre.
double covered(double x) { return (std::acos(2 * x) - 2 * x * std::sqrt(1 - 4 * x * x)) / std::numbers::pi; }

/// Energy that the edge of a large leaf takes in pieces below the share t, per length of edge and diameter.
double lost_at_edges(double t) {
  double lost = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const double x = (i + 0.5) / kSteps - 0.5;
    const double share = x < 0 ? 1 - covered(-x) : covered(x);
    if (share < t) lost += share / kSteps;
  }
  return lost;
}

/// The same of square leaves of side 1 at all angles, over what they take, per diameter. What comes back of a leaf at
/// an angle of cosine c is 1 − 0.35 (1 − c) of that at right angles; its shadow is c large, with edges √(1 − sin² cos²)
/// and √(1 − sin² sin²).
double lost_of_squares(double t) {
  constexpr double kAngle = 0.35, kMean = 1 - kAngle / 3;
  constexpr int kSteps = 100;
  double lost = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double c = (i + 0.5) / kSteps, back = 1 - kAngle * (1 - c), sine2 = 1 - c * c;
    double perimeter = 0;
    for (int j = 0; j < kSteps; ++j) {
      const double turn = (j + 0.5) / kSteps * std::numbers::pi / 2;
      perimeter +=
          2 * (std::sqrt(1 - sine2 * std::pow(std::cos(turn), 2)) + std::sqrt(1 - sine2 * std::pow(std::sin(turn), 2)));
    }
    lost += perimeter / kSteps * back * lost_at_edges(t * kMean / back) / kSteps;
  }
  return lost / (0.5 * kMean);
}

TEST(EchoLoss, ThinBeamsLoseNothing) {
  for (const double share : {0.05, 0.25, 0.5})
    for (const double resolution : {0.0, 0.3, 3.0})
      for (const double depth : {0.0, 1.0, 4.0}) EXPECT_NEAR(ReturnedShare(share, resolution)(0, depth), 1, 1e-12);
  EXPECT_EQ(mean_echo_share(0, 0.3), 1);
}

/// Outside, before beams have lost anything: the table begins at an optical path of 0.25.
double returned_outside(const ReturnedShare& returned, double diameter_sides) {
  return 1.5 * returned(diameter_sides, 0.25) - 0.5 * returned(diameter_sides, 0.75);
}

// In thin canopy what edges take is all; at a fifth of a side corners and other leaves begin to matter.
TEST(EchoLoss, NarrowBeamsLoseWhatEdgesTake) {
  for (const double share : {0.15, 0.25, 0.40}) {
    const double per_width = lost_of_squares(share);
    const ReturnedShare returned(share, kThinCanopy);
    EXPECT_NEAR(returned_outside(returned, 0.1), 1 - 0.1 * per_width, 0.015) << share;
    EXPECT_NEAR(returned_outside(returned, 0.2), 1 - 0.2 * per_width, 0.025) << share;
  }
}

TEST(EchoLoss, MoreIsLostOfWiderBeamsAndAtHigherShares) {
  for (double width = 0.1; width < 1.2; width += 0.1) {
    EXPECT_LT(ReturnedShare(0.25, 0.3)(width + 0.1, 0), ReturnedShare(0.25, 0.3)(width, 0)) << width;
    EXPECT_LT(mean_echo_share(width, 0.25), 1);
    for (double share = 0.05; share < 0.45; share += 0.05)
      EXPECT_LT(ReturnedShare(share + 0.05, 0.3)(width, 0.5), ReturnedShare(share, 0.3)(width, 0.5))
          << width << " " << share;
  }
}

// Outside, where beams still have all their energy: the closer leaves stand behind one another, the more of what is
// below the detection share by itself comes back with others.
TEST(EchoLoss, LessIsLostWhereSeveralLeavesMakeOneEcho) {
  for (const double width : {0.3, 0.6, 1.0})
    for (double path = 0.05; path < 0.4; path *= 2)
      EXPECT_GT(ReturnedShare(0.3, 2 * path)(width, 0), ReturnedShare(0.3, path)(width, 0)) << width << " " << path;
}

TEST(EchoLoss, BeyondTheTableItsEndsHold) {
  EXPECT_EQ(ReturnedShare(0.25, 0.3)(5, 1), ReturnedShare(0.25, 0.3)(1.3, 1));
  EXPECT_EQ(ReturnedShare(0.9, 0.3)(0.3, 1), ReturnedShare(0.5, 0.3)(0.3, 1));
  EXPECT_EQ(ReturnedShare(0.25, 0.3)(0.3, 99), ReturnedShare(0.25, 0.3)(0.3, 2.5));
  EXPECT_EQ(ReturnedShare(0.25, 0)(0.3, 1), ReturnedShare(0.25, 0.01)(0.3, 1));
  EXPECT_EQ(ReturnedShare(0.25, 9)(0.3, 1), ReturnedShare(0.25, 0.7)(0.3, 1));
  EXPECT_EQ(mean_echo_share(0.3, 0), mean_echo_share(0.3, 0.05));
}

}  // namespace
}  // namespace rayfield::density
