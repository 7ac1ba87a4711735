#include "experiments/voxel/leaf_triangles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments/trials/trials.h"
#include "experiments/voxel/voxel_rays.h"
#include "rayfield/experiments/moments.h"

namespace rayfield::experiments {
namespace {

using Eigen::Vector3d;

constexpr double kW = 0.1;

TEST(AreaInside, OfATriangleInTheVoxelIsItsArea) {
  const Triangle triangle{Vector3d(0.02, 0.02, 0.05), Vector3d(0.06, 0.02, 0.05), Vector3d(0.02, 0.05, 0.08)};
  EXPECT_NEAR(area_inside(triangle, kW), 0.5 * 0.04 * std::hypot(0.03, 0.03), 1e-12);
}

TEST(AreaInside, OfATriangleThatCoversASectionIsTheSection) {
  const Triangle level{Vector3d(-1, -1, 0.03), Vector3d(3, -1, 0.03), Vector3d(-1, 3, 0.03)};
  EXPECT_NEAR(area_inside(level, kW), kW * kW, 1e-12);
  // x + y + z = 3w/2 cuts a regular hexagon of side w/√2 out of the cube.
  const Vector3d middle = Vector3d::Constant(kW / 2);
  const Vector3d u = Vector3d(1, -1, 0).normalized(), v = Vector3d(1, 1, -2).normalized();
  const Triangle slanting{middle + 2 * v, middle - 2 * u - v, middle + 2 * u - v};
  EXPECT_NEAR(area_inside(slanting, kW), 1.5 * std::numbers::sqrt3 * kW * kW / 2, 1e-12);
}

TEST(AreaInside, OfATriangleBesideTheVoxelIsZero) {
  const Triangle beside{Vector3d(0.11, 0, 0), Vector3d(0.2, 0, 0), Vector3d(0.11, 0.1, 0)};
  EXPECT_EQ(area_inside(beside, kW), 0);
}

TEST(DistanceTo, IsWhereTheLineMeetsTheTriangle) {
  const Triangle triangle{Vector3d(0, 0, 2), Vector3d(1, 0, 2), Vector3d(0, 1, 2)};
  EXPECT_DOUBLE_EQ(distance_to(triangle, {0.2, 0.2, 0.5}, Vector3d::UnitZ()), 1.5);
  EXPECT_DOUBLE_EQ(distance_to(triangle, {0.2, 0.2, 3}, Vector3d::UnitZ()), -1);
  EXPECT_TRUE(std::isinf(distance_to(triangle, {0.6, 0.6, 0}, Vector3d::UnitZ())));
  EXPECT_TRUE(std::isinf(distance_to(triangle, {0.2, 0.2, 0}, Vector3d::UnitX())));
}

TEST(EquilateralArea, IsRootThreeForASideOfTwo) { EXPECT_DOUBLE_EQ(equilateral_area(2), std::numbers::sqrt3); }

// ∫₀¹ 10z/√(99z² + 1) dz = 10·(10 − 1)/99 for the axis that is stretched.
TEST(LeafNormals, OfAnEllipsoidPreferItsLongAxis) {
  sim::CounterRandom random = trial_random(3, 0, 0);
  Moments stretched, even;
  for (int i = 0; i < 40000; ++i) {
    const Vector3d normal = draw_normal({{10, 1, 1}, NormalBody::sphere}, random);
    EXPECT_NEAR(normal.norm(), 1, 1e-12);
    stretched.add(std::abs(normal.x())), even.add(std::abs(draw_normal({}, random).y()));
  }
  EXPECT_NEAR(stretched.mean().value, 90.0 / 99, 4.5 * stretched.mean().standard_error);
  EXPECT_NEAR(even.mean().value, 0.5, 4.5 * even.mean().standard_error);
}

// Leaves around the voxel put as much area into it as they would into any place of that size, however large they are.
TEST(GrowLeaves, PutsTheExpectedAreaIntoTheVoxel) {
  for (const double side_m : {0.025, 0.15}) {
    const LeafPopulation population{kW, side_m, 0.012, {}};
    Moments area;
    std::vector<Triangle> leaves;
    for (std::uint64_t trial = 0; trial < 4000; ++trial) {
      sim::CounterRandom random = trial_random(5, 0, trial);
      grow_leaves(population, random, leaves);
      area.add(true_density(leaves, kW) * kW * kW * kW);
    }
    EXPECT_NEAR(area.mean().value, 0.012, 4.5 * area.mean().standard_error) << side_m;
  }
}

}  // namespace
}  // namespace rayfield::experiments
