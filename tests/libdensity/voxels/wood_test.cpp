#include "libdensity/voxels/wood.h"

#include <gtest/gtest.h>

#include <utility>

namespace rayfield::density {
namespace {

using Eigen::Vector3d;

const WoodCylinder kPost{1, {2, 3, 10}, Vector3d::UnitZ(), 0.05, 1.8};

TEST(Wood, ARayThroughTheAxisIsInsideForTheDiameterOfTheShell) {
  double in, out;
  ASSERT_TRUE(shell_interval(kPost, 0.02, {0, 3, 11}, {1, 0, 0}, in, out));
  EXPECT_NEAR(in, 1.93, 1e-12);
  EXPECT_NEAR(out, 2.07, 1e-12);
}

TEST(Wood, ABentTrunkIsMaskedWider) {
  WoodCylinder trunk = kPost;
  trunk.bend_m = 0.03;
  double in, out;
  ASSERT_TRUE(shell_interval(trunk, 0.02, {0, 3, 11}, {1, 0, 0}, in, out));
  EXPECT_NEAR(in, 1.90, 1e-12);
  EXPECT_NEAR(out, 2.10, 1e-12);
  EXPECT_FALSE(shell_interval(trunk, 0.02, {0, 3, 11.83}, {1, 0, 0}, in, out));
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

TEST(Wood, APointIsInTheShellWhereARayThatEndsThereIs) {
  WoodCylinder leaning = kPost;
  leaning.axis = Vector3d(0.2, -0.1, 1).normalized(), leaning.bend_m = 0.02;
  const Vector3d origin(0.3, 2.2, 11.5);
  int inside = 0;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      const Vector3d end(2 + 0.01 * (i - 20), 3 + 0.01 * (j - 20), 10 + 0.05 * (i + j) / 2 + 0.0003);
      const Vector3d direction = (end - origin).normalized();
      double in = 0, out = 0;
      const double length = (end - origin).norm();
      const bool met = shell_interval(leaning, 0.02, origin, direction, in, out) && in <= length && length <= out;
      EXPECT_EQ(in_shell(leaning, 0.02, end), met) << end.transpose();
      inside += met ? 1 : 0;
    }
  EXPECT_GT(inside, 50);
}

// A tile at the origin whose ground is level at 5 m, and unknown north of its middle.
GroundModel half_known_ground() {
  Grid2<float> nodes({0, 0}, 12.5, 3, 3, 5.0F);
  for (int ix = 0; ix < 3; ++ix) nodes.at(ix, 2) = std::nanf("");
  GroundModel ground(25.0);
  ground.set({0, 0}, std::move(nodes));
  return ground;
}

TEST(Wood, OnlyDetectedPostsOnKnownGroundBecomeCylinders) {
  RowLayout layout;
  for (const double northing : {2.0, 8.0, 20.0}) {
    Post post;
    post.row = 1, post.position = {1, northing};
    post.height_m = 1.8, post.radius_m = 0.04;
    layout.posts.push_back(post);
  }
  layout.posts[1].detected = false;
  const auto wood = wood_of(layout, half_known_ground());
  ASSERT_EQ(wood.size(), 1u);
  EXPECT_EQ(wood[0].base, Vector3d(1, 2, 5));
  EXPECT_EQ(wood[0].axis, Vector3d::UnitZ());
  EXPECT_EQ(wood[0].length_m, 1.8);
}

TEST(Wood, APostLeansAndATrunkStandsUpright) {
  RowLayout layout;
  Post post;
  post.position = {3, 4}, post.height_m = 2.0, post.lean = {0.75, 0};
  Trunk trunk;
  trunk.position = {5, 4}, trunk.top_m = 0.9, trunk.radius_m = 0.03;
  layout.posts = {post}, layout.trunks = {trunk};
  const auto wood = wood_of(layout, half_known_ground());
  ASSERT_EQ(wood.size(), 2u);
  // Height 2 m with 0.75 m of shift per metre: 3-4-5, a length of 2.5 m along (0.6, 0, 0.8).
  EXPECT_TRUE(wood[0].axis.isApprox(Vector3d(0.6, 0, 0.8), 1e-12));
  EXPECT_NEAR(wood[0].length_m, 2.5, 1e-12);
  EXPECT_EQ(wood[1].axis, Vector3d::UnitZ());
  EXPECT_EQ(wood[1].length_m, 0.9);
  EXPECT_EQ(wood[1].radius_m, 0.03);
  EXPECT_EQ(wood[0].bend_m, 0);
  EXPECT_GT(wood[1].bend_m, 0);  // posts are straight, vines are not
}

TEST(Wood, LinesPassTheAxisAtADistance) {
  EXPECT_NEAR(distance_from_axis(kPost, {0, 3.03, 11}, {1, 0, 0}), 0.03, 1e-12);
  EXPECT_NEAR(distance_from_axis(kPost, {0, 3.03, 11}, {2, 0, 1}), 0.03, 1e-12);     // slanting
  EXPECT_NEAR(distance_from_axis(kPost, {2.04, 3.03, 20}, {0, 0, -1}), 0.05, 1e-9);  // along the axis
}

}  // namespace
}  // namespace rayfield::density
