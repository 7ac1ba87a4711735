#include "libdensity/estimate/voxel_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace rayfield::density {
namespace {

constexpr double kFull = 1000, kShare = 0.25, kSide = 0.08, kVoxel = 0.07, kResolution = 0.15;

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

/// Of a lidar with one beam at a time that does not see `lost` of what leaves take, with kHidden times of it behind
/// beams that return nothing; leaves are large beside the beam.
constexpr double kHidden = 1.3;
EchoModel model_of(double lost) {
  EchoModel model;
  model.full_echo = kFull, model.detection_share = kShare, model.leaf_size_m2 = 1e6, model.echo_variation = 0.2;
  model.range_resolution_m = kResolution, model.mean_width_m = 0.04, model.lost_share = lost;
  model.unreturned_share = kHidden * lost;
  return model;
}

/// Of a row of one voxel.
VoxelSums sums_of(const Voxel& v, const EchoModel& model) {
  return wide_beam_sums(std::vector{v.counters}, std::vector{v.echoes}, {1, 1, kVoxel}, model).at(0);
}

/// By what the path is too long where `lost` of what leaves take is in no echo, in a row with that optical path across:
/// docs/beams.md, "How it is taken out".
double through(double lost, double across, double resolution_m = kResolution) {
  const double hidden = 1.2 * kHidden * lost * across * std::exp(-std::max(0.0, resolution_m - 0.17) / 0.25);
  return std::exp(-hidden - lost * std::min(1.0, 0.45 / across) - 0.26 * std::min(0.2, lost * across));
}
double across(const VoxelSums& s) { return s.hits / s.path; }  // of a row of which the voxel is all there is

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

TEST(VoxelSums, FullEchoesAreTheHitsOfThinRays) {
  const VoxelSums s = sums_of(voxel_with(1, 0.04), model_of(0));
  EXPECT_DOUBLE_EQ(s.hits, 4);
  EXPECT_NEAR(s.path, 8, 1e-3);
  EXPECT_NEAR(s.hit_path, 2, 1e-3);
  EXPECT_NEAR(s.hits_squared, 4 * 1.2, 1e-9);
}

TEST(VoxelSums, OfHalfAnEchoHalfTheBeamRunsOn) {
  const VoxelSums s = sums_of(voxel_with(0.5, 0.04), model_of(0));
  EXPECT_DOUBLE_EQ(s.hits, 2);
  EXPECT_NEAR(s.path, 8 + 0.5 * 1.5, 1e-3);
  EXPECT_NEAR(s.hit_path, 1, 1e-3);
  EXPECT_NEAR(s.potential, 10, 1e-6);
}

TEST(VoxelSums, WhatReturnsNothingIsMissingTheLessTheCoarserTheRangeResolution) {
  const VoxelSums all = sums_of(voxel_with(0.5, 0.04), model_of(0));
  for (const double resolution_m : {0.08, 0.15, 0.35}) {
    EchoModel model = model_of(0.1);
    model.range_resolution_m = resolution_m;
    const VoxelSums s = sums_of(voxel_with(0.5, 0.04), model);
    EXPECT_EQ(s.hits, all.hits);
    EXPECT_NEAR(s.path / through(0.1, across(s), resolution_m), all.path, 0.02);
  }
}

// Half of the surface of thin wood is seen, of what stands across the row; at most four fifths of that are wood.
TEST(VoxelSums, WoodCountsAsItsBrightnessSays) {
  const VoxelSums all = sums_of(voxel_with(0.5, 0.04), model_of(0));
  for (const double per_side : {0.1, 0.3, 3.0})
    for (const double brightness : {0.6, 1.0, 1.3}) {
      EchoModel model = model_of(0);
      model.wood_per_side = per_side, model.wood_brightness = brightness;
      const VoxelSums s = sums_of(voxel_with(0.5, 0.04), model);
      double hits = all.hits;
      for (int round = 1; round < 3; ++round)  // from what the round before says of the row
        hits = all.hits / (1 - std::min(0.8, 0.5 * per_side / (hits / all.path)) * (1 - brightness));
      EXPECT_NEAR(s.path, all.path, 1e-3);
      EXPECT_NEAR(s.hits, hits, 1e-3) << per_side << ", " << brightness;
      EXPECT_NEAR(s.hit_path / s.hits, all.hit_path / all.hits, 1e-6);
      EXPECT_EQ(sums_of(voxel_with(0.5, 0.04), with_wood_as_leaves(model)).hits, all.hits);
      model.wood_returned = 0.8;  // all of it is wood, and the full echo is that of wood
      EXPECT_EQ(sums_of(voxel_with(0.5, 0.04), model).hits, all.hits);
    }
}

// Edges cut beams the more the wider these are beside a leaf, and less where leaves of one range resolution add up.
TEST(VoxelSums, WideBeamsMissWhatEdgesCut) {
  const VoxelSums all = sums_of(voxel_with(0.5, 0.04), model_of(0));
  for (const double width_m : {0.02, 0.04, 0.06}) {
    EchoModel model = model_of(0);
    model.leaf_size_m2 = kSide * kSide;
    const VoxelSums s = sums_of(voxel_with(0.5, width_m), model);
    const double together = s.hits / s.path / kVoxel * kResolution;
    EXPECT_EQ(s.hits, all.hits);
    EXPECT_NEAR(s.path, all.path * std::exp(-width_m / kSide * 0.10 * (1 - 1.5 * together)), 0.01);
  }
}

// Echoes that the lidar does not report are missing: those of less than half the beam before the strongest, those
// before the last. docs/beams.md, "How it is taken out".
TEST(VoxelSums, EchoesThatAreNotReportedAreMissing) {
  for (const double width_m : {0.02, 0.06})
    for (const double share : {0.2, 0.4, 0.6})
      for (const double resolution_m : {0.1, 0.3}) {
        EchoModel model = model_of(0);
        model.leaf_size_m2 = kSide * kSide, model.detection_share = share, model.range_resolution_m = resolution_m;
        const VoxelSums unknown = sums_of(voxel_with(0.5, width_m), model);
        model.beam.returns = ReturnMode::first;
        EXPECT_EQ(sums_of(voxel_with(0.5, width_m), model).path, unknown.path);
        const auto cut_by_edges = [&](const VoxelSums& v) {
          return width_m / kSide * 0.10 * (1 - 1.5 * v.hits / v.path / kVoxel * resolution_m);
        };
        const double below_half = std::max(0.0, 0.5 - share);
        for (const auto& [mode, taken] : {std::pair(ReturnMode::strongest, 1.1 * below_half),
                                          std::pair(ReturnMode::last, 11 * below_half * below_half)}) {
          model.beam.returns = mode;
          const VoxelSums s = sums_of(voxel_with(0.5, width_m), model);
          const double hidden = taken * std::sqrt(width_m / kSide * across(s)) * std::exp(-resolution_m / 0.25);
          EXPECT_EQ(s.hits, unknown.hits);
          EXPECT_NEAR(s.path, unknown.path * std::exp(cut_by_edges(unknown) - cut_by_edges(s) - hidden), 0.05)
              << name_of(mode) << ", " << width_m << " m, " << share;
        }
      }
}

// Two places of a cross section, one behind the other: a ray across the row passes both.
TEST(VoxelSums, TheThickerTheRowTheMoreIsMissing) {
  const Voxel one = voxel_with(0.5, 0.04);
  const std::vector counters{one.counters, one.counters};
  const std::vector echoes{one.echoes, one.echoes};
  constexpr double kLost = 0.1;
  const auto behind = wide_beam_sums(counters, echoes, {2, 1, kVoxel}, model_of(kLost));
  const auto above = wide_beam_sums(counters, echoes, {1, 2, kVoxel}, model_of(kLost));
  const double outside = 8 + 0.5 * 1.5;
  EXPECT_NEAR(behind[0].path, outside * through(kLost, 2 * across(behind[0])), 0.03);
  EXPECT_NEAR(above[0].path, outside * through(kLost, across(above[0])), 0.03);
}

// What is lost of wood is shared among the leaves there are.
TEST(VoxelSums, TheLessLeavesTheMoreOfWhatIsMissingIsWood) {
  EchoModel model = model_of(0.1);
  model.unreturned_share = 0;
  const VoxelSums few = sums_of(voxel_with(0.5, 0.04), model);
  Voxel dense = voxel_with(1, 0.04);
  dense.counters.path = static_cast<std::int64_t>(2 / VoxelCounters::kUnit);
  const VoxelSums many = sums_of(dense, model), all = sums_of(dense, model_of(0));
  ASSERT_GT(across(many), 1);
  EXPECT_NEAR(few.path, (8 + 0.5 * 1.5) * std::exp(-0.1 - 0.26 * 0.1 * across(few)), 0.02);
  EXPECT_NEAR(many.path, all.path * std::exp(-0.45 * 0.1 / across(many) - 0.26 * 0.1 * across(many)), 0.02);
}

// Rows that are dense at one end and bare at the other: what is missing is taken from the metres around.
TEST(VoxelSums, TheThicknessIsThatOfThePlace) {
  const Voxel dense = voxel_with(1, 0.04);
  Voxel bare = dense;
  bare.counters.hits = 0, bare.counters.hit_path = 0, bare.echoes.echo = 0, bare.echoes.echo_behind = 0;
  std::vector<VoxelCounters> counters;
  std::vector<EchoCounters> echoes;
  for (int along = 0; along < 80; ++along) {
    const Voxel& v = along < 40 ? dense : bare;
    counters.push_back(v.counters), echoes.push_back(v.echoes);
  }
  EchoModel model = model_of(0.1);
  model.lost_share = 0;  // of wood, which counts the more the less leaves there are
  const auto sums = wide_beam_sums(counters, echoes, {1, 1, kVoxel}, model);
  EXPECT_NEAR(sums[0].path, sums_of(dense, model).path, 1e-3);
  EXPECT_NEAR(sums[79].path, sums_of(bare, model).path, 1e-3);
  EXPECT_GT(sums[39].path, sums[0].path);
}

TEST(VoxelSums, EchoesBrighterThanAFullOneLeaveAPath) {
  const VoxelSums s = sums_of(voxel_with(20, 0.04), model_of(0.1));
  EXPECT_GT(s.path, 0);
}

}  // namespace
}  // namespace rayfield::density
