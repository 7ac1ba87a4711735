#include "libdensity/voxels/row_segments.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/libdensity/scene.h"

namespace rayfield::density {
namespace {

using testing::BlockShape;
using testing::exact_ground;
using testing::Scene;
using testing::two_rows;

TEST(RowSegments, HaveFacesFromTheQuantilesOfTheCanopyInWholeVoxels) {
  Scene scene(41);
  BlockShape block;
  const RowLayout layout = two_rows(block, 3.0);
  const GroundModel ground = exact_ground([](double, double) { return 100.0; });
  // Uniform within ±0.4 m across, 0.3…1.8 m up: quantiles 2 and 98 % at ±0.384, 97 % at 1.755.
  for (int i = 0; i < 200000; ++i) {
    const Eigen::Vector2d p = block.at(scene.uniform(0, 1), scene.uniform(-0.4, 0.4));
    scene.add_point({p.x(), p.y(), 100 + scene.uniform(0.3, 1.8)});
  }
  RowSegmentOptions options;
  options.voxel_m = 0.12;
  options.widen_voxels = 0;
  const CanopyProfile profile = testing::profile_of(scene.tiles(), layout, ground, options);
  const auto extents = row_extents(layout, profile, options);
  ASSERT_EQ(extents.size(), 2U);
  EXPECT_EQ(extents[0].hits, 200000);
  EXPECT_NEAR(extents[0].across_low_m, -0.384, 0.005);
  EXPECT_NEAR(extents[0].across_high_m, 0.384, 0.005);
  EXPECT_NEAR(extents[0].up_high_m, 0.3 + 0.97 * 1.5, 0.005);
  EXPECT_NEAR(extents[0].across_min_m, -0.48, 1e-9);  // four voxels of 0.12 m
  EXPECT_NEAR(extents[0].across_max_m, 0.48, 1e-9);
  EXPECT_NEAR(extents[0].up_max_m, 0.3 + 13 * 0.12, 1e-9);  // 1.455 m above the low face is 12.1 voxels
  EXPECT_NEAR(extents[0].outside_share, 0, 0.002);
  options.widen_voxels = 2;
  EXPECT_NEAR(row_extents(layout, profile, options)[0].across_max_m, 0.72, 1e-9);
  EXPECT_NEAR(row_extents(layout, profile, options)[0].up_max_m, 0.3 + 15 * 0.12, 1e-9);
  // The other row was not hit: the least grid, nothing invented.
  EXPECT_EQ(extents[1].hits, 0);
  EXPECT_TRUE(std::isnan(extents[1].up_high_m));
  EXPECT_NEAR(extents[1].across_max_m, 0.24, 1e-9);
}

TEST(RowSegments, NeverReachBeyondHalfTheSpacing) {
  Scene scene(42);
  BlockShape block;
  const RowLayout layout = two_rows(block, 1.5);
  const GroundModel ground = exact_ground([](double, double) { return 100.0; });
  scene.add_canopy(block, 0, 0, 1, 2000, 0.6);
  RowSegmentOptions options;
  const auto extents = row_extents(layout, testing::profile_of(scene.tiles(), layout, ground, options), options);
  for (const RowExtents& e : extents) {
    EXPECT_GE(e.across_min_m, -0.75);
    EXPECT_LE(e.across_max_m, 0.75);
  }
}

TEST(RowSegments, CoverTheRowWithoutGapsAndFollowItsCurve) {
  BlockShape block;
  block.radius_m = 60, block.length_m = 40;
  const RowLayout layout = two_rows(block, 2.5);
  const GroundModel ground = exact_ground([](double, double) { return 100.0; });
  const RowSegmentOptions options{.voxel_m = 0.12, .voxels_per_segment = 25};
  const auto list = make_row_segments(layout, ground, {}, options);
  ASSERT_TRUE(list);
  EXPECT_TRUE(list->warnings.empty());
  for (const Row& row : layout.rows) {
    int next = 0, index = 0;
    for (const RowSegment& s : list->row_segments) {
      if (s.row != row.number) continue;
      EXPECT_EQ(s.first_along, next);
      EXPECT_EQ(s.index, index++);
      EXPECT_NEAR(s.chainage_m, next * 0.12, 1e-9);
      EXPECT_NEAR(s.direction.norm(), 1, 1e-12);
      next += s.n_along;
      // The chord's middle lies within l²/8R of the curve, its ends on it.
      const Eigen::Vector2d middle = s.origin + s.direction * (0.5 * s.n_along * s.voxel_m);
      double nearest = 1e9;
      for (int k = 0; k <= 4000; ++k)
        nearest = std::min(nearest, (block.at(k / 4000.0, -(row.number - 1) * 2.5) - middle).norm());
      EXPECT_LT(nearest, 3.0 * 3.0 / (8 * 60) + 0.01);
    }
    EXPECT_GE(next * 0.12, row.length_m() - 1e-6);
    EXPECT_LT(next * 0.12, row.length_m() + 0.12);
  }
}

TEST(RowSegments, ShearAlongThePlaneOfTheGround) {
  BlockShape block;
  block.azimuth_deg = 30;
  // dz/de = 0.06, dz/dn = −0.02; along = (sin 30°, cos 30°), left = (−cos 30°, sin 30°).
  const GroundModel ground =
      exact_ground([](double x, double y) { return 50 + 0.06 * (x - 500000) - 0.02 * (y - 6100000); });
  const auto list = make_row_segments(two_rows(block, 2.5), ground, {}, {});
  ASSERT_TRUE(list);
  ASSERT_FALSE(list->row_segments.empty());
  for (const RowSegment& s : list->row_segments) {
    EXPECT_NEAR(s.slope_along, 0.06 * 0.5 - 0.02 * std::sqrt(0.75), 1e-3);
    EXPECT_NEAR(s.slope_across, -0.06 * std::sqrt(0.75) - 0.02 * 0.5, 1e-3);
    EXPECT_NEAR(s.ground_m, 50 + 0.06 * (s.origin.x() - 500000) - 0.02 * (s.origin.y() - 6100000), 1e-3);
  }
}

TEST(RowSegments, CountHeightsFromTheCrestOfTheBankUnderTheRow) {
  BlockShape block;  // runs along its azimuth from (500000, 6100000); a bank of 0.2 m under each row, on a side slope
  const Eigen::Vector2d left = (block.at(0.5, 1) - block.at(0.5, 0)).normalized();
  const Eigen::Vector2d start = block.at(0, 0);
  const auto ground = [&](double x, double y) {
    const double across = (Eigen::Vector2d(x, y) - start).dot(left);
    const double from_row = across - 2.5 * std::round(across / 2.5);
    return 70 + 0.08 * across + 0.2 * std::exp2(-std::pow(2 * from_row / 0.8, 2));
  };
  RowSegmentOptions options;
  options.min_half_width_m = 0.8;
  const auto list = make_row_segments(two_rows(block, 2.5), exact_ground(ground), {}, options);
  ASSERT_TRUE(list);
  ASSERT_FALSE(list->row_segments.empty());
  for (const RowSegment& s : list->row_segments) {
    EXPECT_NEAR(s.ground_m, ground(s.origin.x(), s.origin.y()), 0.01);
    EXPECT_NEAR(s.slope_across, 0.08, 0.005) << "the side slope, not the bank's flanks";
    EXPECT_NEAR(s.slope_along, 0, 0.001);
  }
}

TEST(RowSegments, OverUnknownGroundAreLeftOutAndNamed) {
  GroundModel nothing(testing::kTile);
  const auto list = make_row_segments(two_rows(BlockShape{}, 2.5), nothing, {}, {});
  ASSERT_TRUE(list);
  EXPECT_TRUE(list->row_segments.empty());
  ASSERT_EQ(list->warnings.size(), 2U);
  EXPECT_NE(list->warnings[0].find("ground"), std::string::npos);
}

TEST(RowSegments, DoNotCountHitsBeyondARowsEnd) {
  Scene scene(43);
  BlockShape block;
  const RowLayout layout = two_rows(block, 3.0);
  const GroundModel ground = exact_ground([](double, double) { return 100.0; });
  scene.add_canopy(block, 0, 0, 1, 100);
  const int inside = static_cast<int>(100 * block.length_m);
  scene.add_canopy(block, 0, 1.01, 1.1, 5000);    // 0.3 m and more beyond the end
  scene.add_canopy(block, 0, -0.1, -0.01, 5000);  // and before the start
  const CanopyProfile profile = testing::profile_of(scene.tiles(), layout, ground, {});
  EXPECT_EQ(row_extents(layout, profile, {})[0].hits, inside);
}

}  // namespace
}  // namespace rayfield::density
