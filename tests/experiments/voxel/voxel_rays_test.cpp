#include "experiments/voxel/voxel_rays.h"

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/trials/trials.h"
#include "rayfield/experiments/moments.h"

namespace rayfield::experiments {
namespace {

using Eigen::Vector3d;

constexpr double kW = 0.1;

// Cauchy: lines that are uniform in space cross a convex body on 4·volume/surface in the mean.
TEST(DrawChord, IsTwoThirdsOfTheVoxelLongInTheMean) {
  sim::CounterRandom random = trial_random(1, 0, 0);
  Moments length;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  constexpr int kLines = 40000;
  for (int i = 0; i < kLines; ++i) {
    const Chord chord = draw_chord(kW, random);
    length.add(chord.length_m);
    sum += chord.entry + 0.5 * chord.length_m * chord.direction;
  }
  EXPECT_NEAR(length.mean().value, 2.0 / 3 * kW, 4.5 * length.mean().standard_error);
  // The middles lie about that of the voxel; a coordinate spreads by less than 0.3 w.
  EXPECT_LT((sum / kLines - Vector3d::Constant(kW / 2)).norm(), 4.5 * 0.3 * kW * std::sqrt(3.0 / kLines));
}

// Volume over shadow: w³/w² along an edge, w³/(√2·w²) at 45° to it.
TEST(DrawParallelChord, IsAsLongInTheMeanAsTheVoxelIsDeepInThatDirection) {
  sim::CounterRandom random = trial_random(2, 0, 0);
  Moments slanting;
  for (int i = 0; i < 20000; ++i) {
    const Chord along = draw_parallel_chord(Vector3d::UnitX(), kW, random);
    EXPECT_NEAR(along.length_m, kW, 1e-12);
    EXPECT_NEAR(along.entry.x(), 0, 1e-12);
    slanting.add(draw_parallel_chord(Vector3d(1, 1, 0).normalized(), kW, random).length_m);
  }
  EXPECT_NEAR(slanting.mean().value, kW / std::sqrt(2.0), 4.5 * slanting.mean().standard_error);
}

TEST(VoxelCounts, EndARayAtItsNearestLeaf) {
  const Triangle far{Vector3d(0.08, -1, -1), Vector3d(0.08, 3, -1), Vector3d(0.08, -1, 3)};
  const Triangle near{Vector3d(0.03, -1, -1), Vector3d(0.03, 3, -1), Vector3d(0.03, -1, 3)};
  const Chord chord{{0, 0.05, 0.05}, Vector3d::UnitX(), kW};
  VoxelCounts counts;
  counts.send(chord, std::vector<Triangle>{far, near});
  counts.send(chord, {});
  EXPECT_EQ(counts.rays, 2U);
  EXPECT_EQ(counts.hits, 1U);
  EXPECT_NEAR(counts.path_m, 0.03 + kW, 1e-12);
  EXPECT_NEAR(counts.hit_path_m, 0.03, 1e-12);
  const VoxelDensities found = densities_of(counts);
  EXPECT_NEAR(found.maximum_likelihood, 2 / 0.13, 1e-9);
  EXPECT_NEAR(found.debiased, 1 / 0.13, 1e-9);
  EXPECT_NEAR(found.unbiased, 2 * (1 / 0.13 - 0.03 / (0.13 * 0.13)), 1e-9);
}

}  // namespace
}  // namespace rayfield::experiments
