#include "sim/vines/leaf_angles.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::sim {
namespace {

// Bounds are five standard errors of the statistic under test.
constexpr int kDraws = 200000;

double mean_cosine(LeafAngles angles, double ratio = 1) {
  const LeafNormals normals(angles, ratio);
  CounterRandom random(2, Stream::leaf);
  double sum = 0;
  for (int i = 0; i < kDraws; ++i) sum += normals.draw(random).z();
  return sum / kDraws;
}

// The mean of cos θ is the projection of unit leaf area on the ground, known in closed form for each distribution.
TEST(LeafNormals, ProjectTheAreaThatTheirDistributionAsksFor) {
  const double pi = std::acos(-1.0), bound = 5 * 0.35 / std::sqrt(kDraws);
  EXPECT_NEAR(mean_cosine(LeafAngles::spherical), 0.5, bound);
  EXPECT_NEAR(mean_cosine(LeafAngles::planophile), 8 / (3 * pi), bound);
  EXPECT_NEAR(mean_cosine(LeafAngles::erectophile), 4 / (3 * pi), bound);
  EXPECT_NEAR(mean_cosine(LeafAngles::plagiophile), (2 / pi) * (1 + 1.0 / 15), bound);
  EXPECT_NEAR(mean_cosine(LeafAngles::extremophile), (2 / pi) * (1 - 1.0 / 15), bound);
  EXPECT_NEAR(mean_cosine(LeafAngles::uniform), 2 / pi, bound);
  EXPECT_NEAR(mean_cosine(LeafAngles::ellipsoidal, 1), 0.5, bound);
}

TEST(LeafNormals, AreFlatterTheLargerTheEllipsoidRatio) {
  EXPECT_GT(mean_cosine(LeafAngles::ellipsoidal, 3), 0.6);
  EXPECT_LT(mean_cosine(LeafAngles::ellipsoidal, 0.3), 0.4);
}

}  // namespace
}  // namespace rayfield::sim
