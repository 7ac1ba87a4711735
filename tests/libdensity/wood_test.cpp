#include "rayfield/density/wood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayfield::density {
namespace {

using Eigen::Vector3d;

const WoodCylinder kPost{1, {2, 3, 10}, Vector3d::UnitZ(), 0.05, 1.8};

TEST(Wood, HalfSurfaceOfAPostCountsTheSideAboveTheGivenHeight) {
  EXPECT_NEAR(half_surface_m2(kPost, 0.3, 9), std::numbers::pi * 0.05 * 1.5, 1e-12);
  EXPECT_EQ(half_surface_m2(kPost, 2.0, 3.0), 0);
}

TEST(Wood, ARayThroughTheAxisIsInsideForTheDiameterOfTheShell) {
  double in, out;
  ASSERT_TRUE(shell_interval(kPost, 0.02, {0, 3, 11}, {1, 0, 0}, in, out));
  EXPECT_NEAR(in, 1.93, 1e-12);
  EXPECT_NEAR(out, 2.07, 1e-12);
}

TEST(Wood, RaysBesideOrAboveThePostMissIt) {
  double in, out;
  EXPECT_FALSE(shell_interval(kPost, 0.02, {0, 3.071, 11}, {1, 0, 0}, in, out));
  EXPECT_FALSE(shell_interval(kPost, 0.02, {0, 3, 11.83}, {1, 0, 0}, in, out));
  EXPECT_FALSE(shell_interval(kPost, 0.02, {2.1, 3, 12}, {0, 0, -1}, in, out));
}

TEST(Wood, AVerticalRayFromAboveEntersThroughTheTop) {
  double in, out;
  ASSERT_TRUE(shell_interval(kPost, 0.02, {2, 3, 13}, {0, 0, -1}, in, out));
  EXPECT_NEAR(in, 13 - 11.82, 1e-12);
  EXPECT_GT(out, 3);
}

TEST(Wood, OnlyDetectedPostsOnKnownGroundBecomeCylinders) {
  std::vector<Post> posts(3);
  for (std::size_t i = 0; i < 3; ++i) {
    posts[i].row = 1, posts[i].position = {1, 2.0 + 6.0 * static_cast<double>(i)};
    posts[i].height_m = 1.8, posts[i].radius_m = 0.04;
  }
  posts[1].detected = false;
  const std::vector<double> ground = {5.0, 5.0, std::nan("")};
  const auto wood = cylinders_of_posts(posts, ground);
  ASSERT_EQ(wood.size(), 1u);
  EXPECT_EQ(wood[0].base, Vector3d(1, 2, 5));
  EXPECT_EQ(wood[0].length_m, 1.8);
}

}  // namespace
}  // namespace rayfield::density
