#include "libdensity/estimate/row_density.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rayfield/density/process.h"
#include "tests/libdensity/hedge_run.h"

namespace rayfield::density {
namespace {

using testing::Agreement;
using testing::compare;
using testing::density_of;
using testing::Hedge;
using testing::HedgeOptions;
using testing::leaf_areas;
using testing::panels_of;
using testing::ScanOptions;
using testing::truth_of;

constexpr double kVoxel = 0.08;

struct RowTotal {
  double plant_area_m2 = 0, leaf_area_m2 = 0;
};
RowTotal total_of(const RowDensity& row) {
  RowTotal total;
  for (int along = 0; along < row.n_along; ++along)
    for (int across = 0; across < row.n_across; ++across)
      for (int up = 0; up < row.n_up; ++up) {
        total.plant_area_m2 += row.plant_area(along, across, up);
        total.leaf_area_m2 += row.canopy_area(along, across, up);
      }
  return total;
}

/// As process() chooses it.
double fitted_voxel(double leaf_size_m2) {
  const VoxelFitOptions fit;
  return std::clamp(std::round(1000 * fit.leaf_sides * std::sqrt(leaf_size_m2)) / 1000, fit.min_m, fit.max_m);
}

HedgeOptions hedge_options(double leaf_cm2, double per_metre, bool wide, bool shoots) {
  HedgeOptions o;
  o.length_m = 18;
  o.leaf_size_m2 = leaf_cm2 * 1e-4, o.leaf_area_per_m = per_metre, o.shoots = shoots;
  if (wide) o.sigma_across_m = 0.32, o.bottom_m = 0.7, o.top_m = 2.0;
  return o;
}

Agreement run(const HedgeOptions& options, double voxel_m, const EstimatorOptions& estimator) {
  const Hedge hedge(options);
  const auto panels = panels_of(hedge, 3);
  return compare(leaf_areas(density_of(hedge, hedge.scan({}), voxel_m, estimator), panels), truth_of(hedge, panels));
}

TEST(RowDensity, LeafAreaOfHedgesOfManyKindsIsFoundWithinThreePercent) {
  for (const bool wide : {false, true})
    for (const double leaf : {35.0, 65.0, 100.0})
      for (const double per_metre : {1.5, 3.0}) {
        const Agreement a = run(hedge_options(leaf, per_metre, wide, false), fitted_voxel(leaf * 1e-4), {});
        EXPECT_NEAR(a.ratio, 1, 0.03) << "wide " << wide << " leaf " << leaf << " per m " << per_metre;
        EXPECT_LT(a.rrmse, 0.06);
        EXPECT_GT(a.slope, 0.85);
      }
}

TEST(RowDensity, LeavesBunchedOnShootsAndSlopesStayWithinFivePercent) {
  // What is bunched below the voxel size shades itself; docs/density.md has the size of the effect.
  for (const double leaf : {35.0, 100.0}) {
    HedgeOptions options = hedge_options(leaf, 2.5, false, true);
    options.slope_x = 0.08, options.slope_y = -0.03;
    const Agreement a = run(options, kVoxel, {});
    EXPECT_NEAR(a.ratio, 1, 0.05) << leaf;
    EXPECT_LT(a.rrmse, 0.06) << leaf;
    EXPECT_GT(a.slope, 0.85) << leaf;
  }
}

TEST(RowDensity, FastAndSlowDrivesAgreeWithinTwoAndAHalfPercent) {
  const Hedge hedge(hedge_options(65, 3, false, true));
  const auto panels = panels_of(hedge, 6);
  ScanOptions fast, slow;
  fast.speed_m_s = 1.5, slow.speed_m_s = 0.45, slow.seed = 8;
  const auto a = leaf_areas(density_of(hedge, hedge.scan(fast), kVoxel, {}), panels);
  const auto b = leaf_areas(density_of(hedge, hedge.scan(slow), kVoxel, {}), panels);
  EXPECT_LT(compare(a, b).rrmse, 0.025);
}

TEST(RowDensity, LeavesThatReachOutOfSmallVoxelsAreCorrectedFor) {
  const HedgeOptions options = hedge_options(100, 1.5, false, false);
  EstimatorOptions none;
  none.leaf_size_m2 = 0;
  const double voxel_m = 0.06, with = run(options, voxel_m, {}).ratio, without = run(options, voxel_m, none).ratio;
  EXPECT_GT(without, 1.08);
  EXPECT_LT(std::abs(with - 1), 0.7 * std::abs(without - 1));
}

TEST(RowDensity, MaskedPostsNeitherAddNorHideLeaves) {
  HedgeOptions options = hedge_options(65, 3, false, false);
  options.post_every_m = 3;
  const Hedge hedge(options);
  const RowDensity row = density_of(hedge, hedge.scan({}), kVoxel, {});
  const RowTotal total = total_of(row);
  EXPECT_NEAR(total.leaf_area_m2 / hedge.leaf_area(-9, 1e9), 1, 0.035);
  // Seven posts: half their surface from 0.3 m to 1.9 m.
  EXPECT_NEAR(total.plant_area_m2 - total.leaf_area_m2, 7 * 3.14159265 * 0.05 * 1.6, 0.02);
  HedgeOptions bare = options;
  bare.leaf_area_per_m = 0.05;
  const Hedge posts_only(bare);
  EXPECT_NEAR(total_of(density_of(posts_only, posts_only.scan({}), kVoxel, {})).leaf_area_m2,
              posts_only.leaf_area(-9, 1e9), 0.25);
}

TEST(RowDensity, AMissingVineIsAGap) {
  HedgeOptions options = hedge_options(35, 3, false, false);
  options.missing_from_m = 7, options.missing_to_m = 9;
  const Hedge hedge(options);
  const auto metres = row_metres(density_of(hedge, hedge.scan({}), kVoxel, {}), 18, {});
  for (const RowMetreProduct& m : metres) {
    if (m.chainage_m > 7.3 && m.chainage_m < 8.7) {
      EXPECT_LT(m.leaf_area_per_m, 0.05);
    }
  }
}

TEST(RowDensity, TheInsideOfADenseHedgeIsPooledOrFilledAndMarked) {
  const Hedge hedge(hedge_options(65, 8, true, false));
  ScanOptions one_side;
  one_side.both_sides = false;
  const RowDensity row = density_of(hedge, hedge.scan(one_side), kVoxel, {});
  std::size_t pooled = 0, filled = 0;
  for (const VoxelState s : row.state) pooled += s == VoxelState::pooled, filled += s == VoxelState::filled;
  EXPECT_GT(pooled, 100u);
  EXPECT_GT(filled, 100u);
}

TEST(RowDensity, WhereNobodyLookedNothingIsInvented) {
  const Hedge hedge(hedge_options(35, 3, false, false));
  tile::SegmentBatch near_start;
  const tile::SegmentBatch rays = hedge.scan({});
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (rays.exit[i].x() < 6 && rays.entry[i].x() < 6) {
      near_start.entry.push_back(rays.entry[i]), near_start.exit.push_back(rays.exit[i]);
      near_start.flags.push_back(rays.flags[i]), near_start.time_s.push_back(0), near_start.intensity.push_back(0);
    }
  const RowDensity row = density_of(hedge, near_start, kVoxel, {});
  const auto values = integrate_panels(row, panels_of(hedge, 6), 2.75, {});
  EXPECT_TRUE(std::isfinite(values[0].plant_area_m2));
  EXPECT_TRUE(std::isnan(values[2].plant_area_m2));
  EXPECT_EQ(values[2].observed_fraction, 0);
  EXPECT_EQ(values[2].ray_count, 0);
}

TEST(RowDensity, ThePublishedMethodBorrowsUntilTenRays) {
  EstimatorOptions paper;
  paper.estimator = Estimator::paper;
  const Agreement a = run(hedge_options(35, 3, false, false), kVoxel, paper);
  EXPECT_NEAR(a.ratio, 1, 0.15);
}

TEST(RowDensity, RowSegmentsOffTheLatticeAndForeignVoxelsAreRefused) {
  const Hedge hedge(hedge_options(35, 1, false, false));
  auto row_segments = hedge.row_segments(0.12, 0.72, 2.4);
  EXPECT_EQ(RowDensityBuilder::create(2, row_segments, {}, {}, {}).error().code, ErrorCode::usage);
  auto builder = RowDensityBuilder::create(1, row_segments, {}, {}, {});
  ASSERT_TRUE(builder.has_value());
  auto other = row_segments;
  other[0].n_up += 1;
  auto accumulator = VoxelAccumulator::create({{0, 0}, 1000}, other, {}, {});
  ASSERT_TRUE(accumulator.has_value());
  TileVoxels voxels = std::move(*accumulator).finish();
  const auto result = builder->add(voxels);
  EXPECT_EQ(result.error().code, ErrorCode::damaged);
  row_segments[1].across_min_m += 0.05;
  EXPECT_EQ(RowDensityBuilder::create(1, row_segments, {}, {}, {}).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::density
