#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "libdensity/estimate/row_fill.h"
#include "libdensity/estimate/slab_density.h"
#include "tests/libdensity/voxel_worlds.h"

/// Voxels counted by hand, from the density that each has: what becomes of them in slabs.
namespace rayfield::density {
namespace {

using testing::make_row_segment;

/// Numbers of rays of one voxel side each through every voxel, [(along·n_across + across)·n_up + up].
struct Scene {
  RowSegment row_segment;
  std::vector<int> rays;
  std::vector<double> rate;  ///< λ per voxel side

  explicit Scene(int n_along, int n_up) : row_segment(make_row_segment()) {
    row_segment.n_along = n_along, row_segment.n_across = 1, row_segment.n_up = n_up;
    rays.assign(static_cast<std::size_t>(n_along * n_up), 10);
    rate.assign(rays.size(), 1);
  }
  std::size_t at(int along, int up) const { return static_cast<std::size_t>(along * row_segment.n_up + up); }

  RowDensity observe(std::mt19937_64& rng) const {
    std::vector<VoxelCounters> counters(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      VoxelCounters& v = counters[i];
      std::exponential_distribution<double> free_path(std::max(rate[i], 1e-300));
      for (int k = 0; k < rays[i]; ++k) {
        const double x = free_path(rng), u = std::min(x, 1.0);
        const auto path = std::llround(u / VoxelCounters::kUnit);
        ++v.rays, v.path += path, v.potential += std::llround(1 / VoxelCounters::kUnit);
        if (x < 1) ++v.hits, v.hit_path += path;
      }
    }
    RowDensity row;
    row.voxel_m = row_segment.voxel_m;
    row.n_along = row_segment.n_along, row.n_across = 1, row.n_up = row_segment.n_up;
    row.density.assign(rays.size(), 0), row.variance.assign(rays.size(), 0);
    row.state.assign(rays.size(), VoxelState::unobserved);
    const std::vector<VoxelSums> sums = thin_ray_sums(counters);
    estimate_slabs(row, sums);
    pool_and_fill(row, sums);
    return row;
  }
};

double mean_rate(const RowDensity& row) {
  double sum = 0;
  for (const float d : row.density) sum += static_cast<double>(d);
  return sum / static_cast<double>(row.density.size()) * row.voxel_m / 2;
}

struct Average {
  double mean = 0, se = 0;
};

Average average(const Scene& scene, int trials) {
  std::mt19937_64 rng(3);
  double sum = 0, square = 0;
  for (int t = 0; t < trials; ++t) {
    const double x = mean_rate(scene.observe(rng));
    sum += x, square += x * x;
  }
  const double mean = sum / trials;
  return {mean, std::sqrt((square / trials - mean * mean) / trials)};
}

TEST(SlabDensity, IsUnbiasedHoweverUnevenlyTheVoxelsOfAPoissonMediumAreSeen) {
  for (const double rate : {0.1, 0.4, 1.5}) {
    Scene scene(8, 6);
    std::mt19937_64 rng(4);
    std::fill(scene.rate.begin(), scene.rate.end(), rate);
    for (int& n : scene.rays) n = std::geometric_distribution<int>(0.2)(rng);  // also 0 and 1
    const Average a = average(scene, 4000);
    EXPECT_NEAR(a.mean, rate, 0.004 * rate + 3.5 * a.se) << rate;
  }
}

TEST(SlabDensity, WhereRaysAreFewCountsForMoreThanInASumOfAllRays) {
  // A chequered plane: thin leaves where few rays come, none where many come. The weights P/(P + P̄) take half of the
  // bias of m/S over all rays, P_few/(P_few + P_many), away when exposures differ twofold.
  for (const auto& [few, many] : {std::pair{40, 80}, std::pair{20, 200}}) {
    Scene scene(40, 12);
    for (int a = 0; a < 40; ++a)
      for (int u = 0; u < 12; ++u) {
        const bool leaves = (a + u) % 2 == 0;
        scene.rate[scene.at(a, u)] = leaves ? 0.05 : 0, scene.rays[scene.at(a, u)] = leaves ? few : many;
      }
    const double middle = 0.5 * (few + many), x = few / (few + middle), y = many / (many + middle);
    const double expected = 2 * x / (x + y), all_rays = 2.0 * few / (few + many);
    const double found = average(scene, 400).mean / 0.025;
    EXPECT_NEAR(found, expected, 0.03) << few << " of " << many;
    EXPECT_GT(found, all_rays + (few == 40 ? 0.45 : 0.2) * (1 - all_rays));
  }
}

TEST(SlabDensity, WhatIsEmptyStaysEmptyAndTheHitsGetTheArea) {
  Scene scene(9, 5);
  std::fill(scene.rate.begin(), scene.rate.end(), 0);
  scene.rate[scene.at(4, 2)] = 0.05;
  std::fill(scene.rays.begin(), scene.rays.end(), 20000);
  std::mt19937_64 rng(5);
  const RowDensity row = scene.observe(rng);
  for (std::size_t i = 0; i < row.density.size(); ++i)
    if (i != scene.at(4, 2)) {
      EXPECT_EQ(row.density[i], 0) << i;
    }
  EXPECT_NEAR(static_cast<double>(row.density[scene.at(4, 2)]) * row.voxel_m / 2, 0.05, 0.005);
}

TEST(SlabDensity, UnseenVoxelsTakeTheValueOfTheirSlab) {
  Scene scene(7, 5);
  scene.rays[scene.at(3, 2)] = 0;
  std::mt19937_64 rng(6);
  const RowDensity row = scene.observe(rng);
  EXPECT_EQ(row.state[scene.at(3, 2)], VoxelState::filled);
  EXPECT_NEAR(static_cast<double>(row.density[scene.at(3, 2)]) * row.voxel_m / 2, 1, 0.4);
  EXPECT_EQ(row.state[scene.at(3, 3)], VoxelState::observed);
}

TEST(SlabDensity, TheStandardErrorOfASumIsTheSpreadOfRepeatedCounts) {
  Scene scene(10, 6);
  std::fill(scene.rate.begin(), scene.rate.end(), 0.5);
  std::mt19937_64 rng(7);
  double sum = 0, square = 0, variance = 0;
  const int trials = 2000;
  for (int t = 0; t < trials; ++t) {
    const RowDensity row = scene.observe(rng);
    double total = 0;
    for (std::size_t i = 0; i < row.density.size(); ++i)
      total += static_cast<double>(row.density[i]), variance += static_cast<double>(row.variance[i]) / trials;
    sum += total, square += total * total;
  }
  const double spread = square / trials - std::pow(sum / trials, 2);
  EXPECT_NEAR(variance / spread, 1, 0.12);
}

}  // namespace
}  // namespace rayfield::density
