#include "libdensity/estimate/uneven_density.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "libdensity/estimate/row_fill.h"
#include "libdensity/estimate/slab_density.h"

namespace rayfield::density {
namespace {

constexpr double kVoxelM = 0.1;

VoxelSums seen(double potential, double stopped_share) {
  VoxelSums v;
  v.potential = potential, v.ends = static_cast<std::uint32_t>(std::lround(potential * stopped_share));
  return v;
}

TEST(PotentialOfTwo, IsWhatComesInFromBothSides) {
  // 300 rays from the left, 200 from the right; the left voxel stops 0.4 of what crosses it, the right one 0.2.
  const double left = 300 + 0.8 * 200, right = 200 + 0.6 * 300;
  EXPECT_NEAR(potential_of_two(seen(left, 0.4), seen(right, 0.2)), 500, 2);
  EXPECT_EQ(potential_of_two(seen(100, 0), seen(60, 0)), 80) << "nothing is stopped: each ray crosses both";
  EXPECT_EQ(potential_of_two(VoxelSums{}, VoxelSums{}), 0);
  EXPECT_LE(potential_of_two(seen(10, 1), seen(7, 1)), 17);
}

/// A row whose density goes with `rate(along, across, up)`, hits per voxel side, constant over columns of 1/`finer` of
/// a voxel; level rays across it from either side, in the middle of those columns.
struct Wall {
  int n_along = 30, n_across = 10, n_up = 8, finer = 4;
  int rays_each = 6;  ///< per column and side
  double mean = 0;    ///< of the rates that were drawn

  template <class Rate>
  RowDensity observe(std::mt19937_64& rng, Rate rate) {
    const int a_count = n_along * finer, c_count = n_across * finer, u_count = n_up * finer;
    std::vector<double> rates(static_cast<std::size_t>(a_count) * static_cast<std::size_t>(c_count * u_count));
    const auto at = [&](int a, int c, int u) { return static_cast<std::size_t>((a * c_count + c) * u_count + u); };
    mean = 0;
    for (int a = 0; a < a_count; ++a)
      for (int c = 0; c < c_count; ++c)
        for (int u = 0; u < u_count; ++u) {
          const double r = rate(a, c, u);
          rates[at(a, c, u)] = r, mean += r / static_cast<double>(rates.size());
        }
    RowDensity row;
    row.voxel_m = kVoxelM, row.n_along = n_along, row.n_across = n_across, row.n_up = n_up;
    std::vector<VoxelCounters> counters(row.shape().size());
    std::exponential_distribution<double> optical_depth(1);
    const double step = 1.0 / finer;
    for (int a = 0; a < a_count; ++a)
      for (int u = 0; u < u_count; ++u)
        for (int k = 0; k < 2 * rays_each; ++k) {
          double left = optical_depth(rng);
          for (int voxel = 0; voxel < n_across && left > 0; ++voxel) {
            const int across = k % 2 == 0 ? voxel : n_across - 1 - voxel;
            double u_in = 0;
            for (int part = 0; part < finer && left > 0; ++part) {
              const int c = across * finer + (k % 2 == 0 ? part : finer - 1 - part);
              const double taken = rates[at(a, c, u)] * step;
              u_in += taken > left ? step * left / taken : step;
              left -= taken;
            }
            VoxelCounters& v = counters[row.index(a / finer, across, u / finer)];
            const auto path = std::llround(u_in / VoxelCounters::kUnit);
            ++v.rays, v.path += path, v.potential += std::llround(1 / VoxelCounters::kUnit);
            if (left <= 0) ++v.hits, v.hit_path += path;
          }
        }
    row.density.assign(counters.size(), 0), row.variance.assign(counters.size(), 0);
    row.state.assign(counters.size(), VoxelState::unobserved);
    const std::vector<VoxelSums> sums = thin_ray_sums(counters);
    estimate_slabs(row, sums);
    pool_and_fill(row, sums);
    before = mean_rate(row);
    correct_uneven_density(row, sums);
    return row;
  }
  double before = 0;  ///< mean rate read without the correction

  static double mean_rate(const RowDensity& row) {
    double sum = 0;
    for (const float d : row.density) sum += static_cast<double>(d);
    return sum / static_cast<double>(row.density.size()) * row.voxel_m / 2;
  }
};

TEST(UnevenDensity, EvenDensityIsLeftAsItIs) {
  std::mt19937_64 rng(11);
  for (const double rate : {0.05, 0.3}) {
    double corrected = 0, before = 0;
    for (int trial = 0; trial < 8; ++trial) {
      Wall wall;
      corrected += Wall::mean_rate(wall.observe(rng, [rate](int, int, int) { return rate; })), before += wall.before;
    }
    EXPECT_NEAR(corrected / before, 1, 0.01) << rate;
    EXPECT_NEAR(corrected / 8, rate, 0.02 * rate) << rate;
  }
}

TEST(UnevenDensity, SomeOfWhatRaysThatPreferTheEmptyMissIsPutBack) {
  // A third of the volume, in cubes of two voxels that lie askew to them, holds everything.
  std::mt19937_64 rng(12);
  std::bernoulli_distribution filled(1.0 / 3);
  double truth = 0, corrected = 0, before = 0;
  for (int trial = 0; trial < 6; ++trial) {
    Wall wall;
    std::vector<double> cubes(40 * 40 * 40);
    for (double& cube : cubes) cube = filled(rng) ? 0.4 : 0;
    const int side = 2 * wall.finer, shift = side / 4;
    const auto rate = [&](int a, int c, int u) {
      const auto cube = [&](int i) { return static_cast<std::size_t>((i + shift) / side); };
      return cubes[(cube(a) * 40 + cube(c)) * 40 + cube(u)];
    };
    corrected += Wall::mean_rate(wall.observe(rng, rate));
    truth += wall.mean, before += wall.before;
  }
  EXPECT_LT(before / truth, 0.96) << "what there is to be put back";
  EXPECT_LT(corrected / truth, 1.03);
  EXPECT_LT(std::abs(1 - corrected / truth), 0.8 * (1 - before / truth));
}

TEST(UnevenDensity, FewRaysScatterTheCorrectionButDoNotBiasIt) {
  std::mt19937_64 rng(13);
  double corrected = 0, before = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Wall wall;
    wall.n_along = 12, wall.finer = 1, wall.rays_each = 3;
    corrected += Wall::mean_rate(wall.observe(rng, [](int, int, int) { return 0.05; })), before += wall.before;
  }
  EXPECT_NEAR(corrected / before, 1, 0.02);
}

TEST(UnevenDensity, LeavesAmongWoodHaveTheirShareOfTheCorrection) {
  RowDensity plant, wood;
  plant.uneven = {1.10, 1.04}, plant.two_sizes = {{10, 8}};
  wood.uneven = {1.20, 1.20}, wood.two_sizes = {{4, 3}};
  const std::vector<double> leaves = correction_of_leaves(plant, wood);
  ASSERT_EQ(leaves.size(), 2U);
  EXPECT_NEAR(leaves[0], 1.06, 1e-12);
  EXPECT_NEAR(leaves[1], 1.024, 1e-12);
  EXPECT_EQ(correction_of_leaves(wood, plant).front(), 1) << "more wood than plant: noise";
}

}  // namespace
}  // namespace rayfield::density
