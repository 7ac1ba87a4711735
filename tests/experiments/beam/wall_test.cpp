#include "experiments/beam/wall.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::experiments {
namespace {

TEST(Wall, VoxelsAreFittedToTheLeavesAsInAScan) {
  EXPECT_DOUBLE_EQ(fitted_voxel_m(0.01), 0.085);   // 0.85 of the side of 100 cm²
  EXPECT_DOUBLE_EQ(fitted_voxel_m(0.001), 0.060);  // the least
  EXPECT_DOUBLE_EQ(fitted_voxel_m(0.05), 0.120);   // the largest
}

TEST(Wall, VoxelsHoldAllLeavesWithTheirRims) {
  BeamExperimentOptions options;
  const auto wall = build_wall(options, 3, 0.01, 1);
  ASSERT_TRUE(wall);
  const Eigen::Vector3d voxels(wall->block.n_along, wall->block.n_across, wall->block.n_up);
  const Eigen::Vector3d high = wall->block.low_m + wall->block.voxel_m * voxels;
  const Eigen::Vector3d size(options.length_m, options.thickness_m, options.height_m);
  const double rim = 0.5 * 1.05 * std::sqrt(2 * 0.01);  // half of the longer diagonal
  EXPECT_LT(wall->block.low_m.maxCoeff(), -rim);
  EXPECT_GT((high - size).minCoeff(), rim);
  EXPECT_NEAR(wall->leaves.leaf_area_m2(), size.prod() * 3, 0.01);
}

TEST(Wall, IsPassedOnBothSidesByFansOfNeighbouringBeamsInTheOrderOfTime) {
  BeamExperimentOptions options;
  const auto wall = build_wall(options, 3, 0.01, 1);
  ASSERT_TRUE(wall);
  std::size_t left = 0, neighbours = 0;
  for (std::size_t i = 0; i < wall->pulses.size(); ++i) {
    const sim::Pulse& pulse = wall->pulses[i];
    EXPECT_NEAR(pulse.direction.norm(), 1, 1e-12);
    EXPECT_NEAR(std::abs(pulse.origin.y() - options.thickness_m / 2), options.distance_m, 1e-9);
    left += pulse.origin.y() < 0 ? 1U : 0U;
    if (i == 0) continue;
    EXPECT_GT(pulse.time_s, wall->pulses[i - 1].time_s);
    neighbours += pulse.direction.dot(wall->pulses[i - 1].direction) > std::cos(0.012) ? 1U : 0U;  // 2/3° is 0.0116
  }
  EXPECT_NEAR(static_cast<double>(left) / static_cast<double>(wall->pulses.size()), 0.5, 0.05);
  EXPECT_GT(neighbours, wall->pulses.size() * 9 / 10);
}

}  // namespace
}  // namespace rayfield::experiments
