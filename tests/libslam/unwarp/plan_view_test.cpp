#include "rayfield/slam/plan_view.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace rayfield::slam {
namespace {

TEST(PlanGrid, CountsHitsInTheirCells) {
  Trajectory standing;
  for (int k = 0; k < 3; ++k)
    standing.poses.push_back({100.0 + 0.1 * k, {Eigen::Quaterniond::Identity(), {500, 600, 7}}});
  auto grid = plan_grid(standing, 10, 0.5);
  RayBatch rays;
  rays.push({500, 600, 7}, {503.1, 598.2, 5}, 1, 0, true);
  rays.push({500, 600, 7}, {503.1, 598.2, 5}, 1, 0, false);
  rays.push({500, 600, 7}, {900, 598.2, 5}, 1, 0, true);
  add_hits(grid, rays);
  std::uint64_t sum = 0;
  for (const auto v : grid.values) sum += v;
  EXPECT_EQ(sum, 1u);
  EXPECT_EQ(grid.at(static_cast<int>((503.1 - 490) / 0.5), static_cast<int>((598.2 - 590) / 0.5)), 1u);
}

}  // namespace
}  // namespace rayfield::slam
