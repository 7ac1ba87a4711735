#include "rayfield/density/voxel_block.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rayfield::density {
namespace {

constexpr double kRate = 1.5;  // hits per metre

VoxelBlock make_block() { return {Eigen::Vector3d(-0.5, 2, -1), 10, 5, 12, 0.1}; }

VoxelBlockOptions infinitesimal_leaves() {
  VoxelBlockOptions options;
  options.voxels.sure_return_m = 0;
  options.estimator.leaf_size_m2 = 0;
  return options;
}

/// Rays along y through all of the block, each with a free path of its own: leaves without size.
RayBatch rays_through(const VoxelBlock& block, int count, const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::exponential_distribution<double> free_path(kRate);
  RayBatch rays;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d at(uniform(random) * block.n_along, 0, uniform(random) * block.n_up);
    const Eigen::Vector3d origin = block.low_m + block.voxel_m * at + shift;
    const double x = free_path(random), depth = block.voxel_m * block.n_across;
    rays.push(origin, origin + std::min(x, depth + 1) * Eigen::Vector3d::UnitY(), i, 100, x < depth);
  }
  return rays;
}

// Density 2·λ in every voxel. Hits are counts: their relative error is 1/√m, which the area shares.
TEST(VoxelBlock, OfLeavesWithoutSizeHoldsTwiceTheHitsPerMetre) {
  const VoxelBlock block = make_block();
  constexpr int kRays = 60000;
  const auto found = estimate_voxel_block(block, rays_through(block, kRays), {}, infinitesimal_leaves());
  ASSERT_TRUE(found);
  const double area = 2 * kRate * 1.0 * 0.5 * 1.2, hits = kRays * (1 - std::exp(-kRate * 0.5));
  EXPECT_NEAR(found->area_m2 / area, 1, 4.5 / std::sqrt(hits));
  ASSERT_EQ(found->density_m2_m3.size(), 600U);
  double sum = 0;
  for (const float density : found->density_m2_m3) sum += 0.001 * static_cast<double>(density);
  EXPECT_NEAR(sum, found->area_m2, 1e-6);
  EXPECT_FALSE(found->echoes);
}

TEST(VoxelBlock, IsTheSameWhereverItLies) {
  const VoxelBlock here = make_block();
  VoxelBlock there = here;
  const Eigen::Vector3d shift(1024, -4096, 256);
  there.low_m += shift;
  const auto a = estimate_voxel_block(here, rays_through(here, 5000), {}, infinitesimal_leaves());
  const auto b = estimate_voxel_block(there, rays_through(here, 5000, shift), {}, infinitesimal_leaves());
  ASSERT_TRUE(a && b);
  EXPECT_NEAR(a->area_m2, b->area_m2, 1e-3 * a->area_m2);
}

TEST(VoxelBlock, ThatRaysCrossFreelyIsEmpty) {
  const VoxelBlock block = make_block();
  RayBatch rays = rays_through(block, 2000);
  for (std::size_t i = 0; i < rays.size(); ++i)
    rays.hit[i] = 0, rays.end[i] = rays.origin[i] + 2 * Eigen::Vector3d::UnitY();
  const auto found = estimate_voxel_block(block, rays, {}, infinitesimal_leaves());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->area_m2, 0);
}

TEST(VoxelBlock, CountsEchoesOfAWideBeamAsHitsWhereTheyTellNothingOrAreNotToBeWeighed) {
  const VoxelBlock block = make_block();
  const RayBatch rays = rays_through(block, 60000);  // echoes all of one strength: they tell nothing
  const LidarBeam beam{0.03, 0, {}};
  const auto thin = estimate_voxel_block(block, rays, {}, infinitesimal_leaves());
  const auto wide = estimate_voxel_block(block, rays, beam, infinitesimal_leaves());
  VoxelBlockOptions counted = infinitesimal_leaves();
  counted.beam.enabled = false;
  const auto disabled = estimate_voxel_block(block, rays, beam, counted);
  ASSERT_TRUE(thin && wide && disabled);
  EXPECT_FALSE(wide->echoes);
  EXPECT_DOUBLE_EQ(wide->area_m2, thin->area_m2);
  EXPECT_DOUBLE_EQ(disabled->area_m2, thin->area_m2);
}

// Halves of full echoes are halves of hits, and the other half of the beam goes on behind them: the same rays seen by a
// lidar that is twice as bright hold less, and never more.
TEST(VoxelBlock, WeighsEchoesByTheFullEchoThatIsGiven) {
  const VoxelBlock block = make_block();
  RayBatch rays = rays_through(block, 60000);
  for (std::size_t i = 0; i < rays.size(); ++i) rays.intensity[i] = i % 2 == 0 ? 80 : 120;
  const LidarBeam beam{0.005, 0, 0.25};
  VoxelBlockOptions options = infinitesimal_leaves();
  options.estimator.leaf_size_m2 = 0.04;  // 20 cm: the beam is thin beside such leaves, and nothing is lost
  options.beam.full_echo = 100;
  const auto full = estimate_voxel_block(block, rays, beam, options);
  options.beam.full_echo = 200;
  const auto half = estimate_voxel_block(block, rays, beam, options);
  ASSERT_TRUE(full && half);
  ASSERT_TRUE(full->echoes && half->echoes);
  EXPECT_EQ(half->echoes->full_echo, 200);
  EXPECT_EQ(half->echoes->detection_share, 0.25);
  EXPECT_LT(half->area_m2, 0.55 * full->area_m2);
}

TEST(VoxelBlock, RefusesABlockWithoutVoxelsAndOptionsOutOfRange) {
  VoxelBlock block = make_block();
  block.n_up = 0;
  EXPECT_EQ(estimate_voxel_block(block, {}, {}, {}).error().code, ErrorCode::usage);
  VoxelBlockOptions options;
  options.beam.range_resolution_m = -1;
  EXPECT_EQ(estimate_voxel_block(make_block(), {}, {}, options).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::density
