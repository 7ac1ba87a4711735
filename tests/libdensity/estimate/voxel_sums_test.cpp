#include "libdensity/estimate/voxel_sums.h"

#include <gtest/gtest.h>

#include "libdensity/echoes/echo_loss.h"

namespace rayfield::density {
namespace {

constexpr double kFull = 1000, kSide = 0.08;

/// Ten rays, four hits of the same share of a full echo; of 1.5 voxel sides behind them.
struct Voxel {
  VoxelCounters counters;
  EchoCounters echoes;
};
Voxel voxel_with(double share, double width_m) {
  Voxel v;
  const auto path = [](double sides) { return static_cast<std::int64_t>(sides / VoxelCounters::kUnit); };
  v.counters = {10, 4, path(8), path(2), path(10)};
  const auto units = EchoCounters::path_units(8), behind = EchoCounters::path_units(1.5);
  v.echoes.echo = static_cast<std::int64_t>(4 * share * kFull);
  v.echoes.width = units * EchoCounters::width_units(width_m);
  v.echoes.behind = behind,
  v.echoes.echo_behind = static_cast<std::int64_t>(share * kFull * static_cast<double>(behind));
  return v;
}

VoxelSums sums_of(const Voxel& v) {
  EchoModel model;
  model.full_echo = kFull, model.detection_share = 0.25, model.leaf_area_m2 = kSide * kSide, model.echo_variation = 0.2;
  return wide_beam_sums(std::vector{v.counters}, std::vector{v.echoes}, model).at(0);
}

TEST(VoxelSums, ThinRaysAreTakenAsCounted) {
  const VoxelCounters c = voxel_with(1, 0).counters;
  const VoxelSums s = thin_ray_sums(std::vector{c}).at(0);
  EXPECT_EQ(s.rays, 10u);
  EXPECT_EQ(s.hits, 4);
  EXPECT_EQ(s.hits_squared, 4);
  EXPECT_EQ(s.path, c.path_sides());
  EXPECT_EQ(s.hit_path, c.hit_path_sides());
  EXPECT_EQ(s.potential, c.potential_sides());
}

TEST(VoxelSums, FullEchoesOfNarrowBeamsAreTheHitsOfThinRays) {
  const VoxelSums s = sums_of(voxel_with(1, 0));
  EXPECT_DOUBLE_EQ(s.hits, 4);
  EXPECT_NEAR(s.path, 8, 1e-6);
  EXPECT_NEAR(s.hit_path, 2, 1e-6);
  EXPECT_NEAR(s.hits_squared, 4 * 1.2, 1e-9);
}

TEST(VoxelSums, OfHalfAnEchoHalfTheBeamRunsOn) {
  const VoxelSums s = sums_of(voxel_with(0.5, 0));
  EXPECT_DOUBLE_EQ(s.hits, 2);
  EXPECT_NEAR(s.path, 8 + 0.5 * 1.5, 1e-3);
  EXPECT_NEAR(s.hit_path, 1, 1e-6);
  EXPECT_NEAR(s.potential, 10, 1e-6);
}

TEST(VoxelSums, OfWideBeamsThatIsMissingWhichReturnsNothing) {
  const VoxelSums narrow = sums_of(voxel_with(0.5, 0)), wide = sums_of(voxel_with(0.5, 0.04));
  EXPECT_EQ(wide.hits, narrow.hits);
  EXPECT_NEAR(wide.path / narrow.path, returned_share(0.04 / kSide, 0.25, 0), 1e-4);
}

TEST(VoxelSums, TheDeeperTheMore) {
  Voxel deep = voxel_with(0.5, 0.04);
  deep.echoes.depth = EchoCounters::path_units(8) * EchoCounters::depth_units(6);  // 6 sides of a quarter hit each
  EXPECT_LT(sums_of(deep).path, 0.97 * sums_of(voxel_with(0.5, 0.04)).path);
}

TEST(VoxelSums, EchoesBrighterThanAFullOneLeaveAPath) {
  const VoxelSums s = sums_of(voxel_with(20, 0));
  EXPECT_GT(s.path, 0);
}

}  // namespace
}  // namespace rayfield::density
