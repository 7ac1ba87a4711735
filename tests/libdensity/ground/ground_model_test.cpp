#include "libdensity/ground/ground_model.h"

#include <gtest/gtest.h>

#include <limits>

namespace rayfield::density {
namespace {

TEST(GroundModel, InterpolatesBetweenNodesAndHasNoValueBesideUnknownOnes) {
  GroundModel model(2.0);
  Grid2<float> nodes({4, 6}, 1.0, 3, 3);
  for (int iy = 0; iy < 3; ++iy)
    for (int ix = 0; ix < 3; ++ix) nodes.at(ix, iy) = static_cast<float>(10 + ix + 2 * iy);
  nodes.at(2, 2) = std::numeric_limits<float>::quiet_NaN();
  model.set({2, 3}, nodes);
  EXPECT_NEAR(model.height(4.25, 6.5).value(), 10 + 0.25 + 1.0, 1e-6);
  EXPECT_NEAR(model.height(4, 6).value(), 10, 1e-6);
  EXPECT_FALSE(model.height(5.5, 7.5));
  EXPECT_FALSE(model.height(3.99, 6.5));
}

}  // namespace
}  // namespace rayfield::density
