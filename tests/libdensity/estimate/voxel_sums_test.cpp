#include "libdensity/estimate/voxel_sums.h"

#include <gtest/gtest.h>

#include "libdensity/echoes/echo_loss.h"

namespace rayfield::density {
namespace {

constexpr double kFull = 1000, kSide = 0.08, kVoxel = 0.07;

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

EchoModel model_of(double range_resolution_m) {
  EchoModel model;
  model.full_echo = kFull, model.detection_share = 0.25, model.leaf_size_m2 = kSide * kSide, model.echo_variation = 0.2;
  model.range_resolution_m = range_resolution_m;
  return model;
}

/// Of a row of one voxel, of a lidar that tells leaves apart that stand right behind each other.
VoxelSums sums_of(const Voxel& v) {
  return wide_beam_sums(std::vector{v.counters}, std::vector{v.echoes}, {1, kVoxel}, model_of(0)).at(0);
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
  EXPECT_NEAR(wide.path / narrow.path, ReturnedShare(0.25, 0)(0.04 / kSide, 0), 1e-4);
}

TEST(VoxelSums, TheDeeperTheMore) {
  Voxel deep = voxel_with(0.5, 0.04);
  deep.echoes.depth = EchoCounters::path_units(8) * EchoCounters::depth_units(6);  // 6 sides of a quarter hit each
  EXPECT_LT(sums_of(deep).path, 0.97 * sums_of(voxel_with(0.5, 0.04)).path);
}

// Two cross sections of two voxels, one place with twice the hits of the other, voxels alike along the row: hits per
// path are h and 2 h, the mean over hits (h² + 4 h²)/(h + 2 h) = 5/3 h.
TEST(VoxelSums, HowManyLeavesMakeAnEchoIsTakenFromTheCrossSection) {
  const Voxel few = voxel_with(0.5, 0.04);
  Voxel many = few;
  many.counters.hits *= 2, many.echoes.echo *= 2;
  const std::vector counters{few.counters, many.counters, few.counters, many.counters};
  const std::vector echoes{few.echoes, many.echoes, few.echoes, many.echoes};
  const auto sums = wide_beam_sums(counters, echoes, {2, kVoxel}, model_of(3 * kVoxel));
  const VoxelSums narrow = sums_of(voxel_with(0.5, 0));
  // R is that of the round before; three rounds leave less than a thousandth of it.
  const double returned = sums[0].path / narrow.path;
  const double around = 5.0 / 3.0 * narrow.hits / (returned * narrow.path);
  EXPECT_NEAR(returned, ReturnedShare(0.25, 3 * around)(0.04 / kSide, 0), 2e-3);
  EXPECT_GT(returned, sums_of(few).path / narrow.path + 0.02);
  EXPECT_EQ(sums[2].path, sums[0].path);
}

TEST(VoxelSums, EchoesBrighterThanAFullOneLeaveAPath) {
  const VoxelSums s = sums_of(voxel_with(20, 0));
  EXPECT_GT(s.path, 0);
}

}  // namespace
}  // namespace rayfield::density
