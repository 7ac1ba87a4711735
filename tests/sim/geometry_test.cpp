#include <cmath>
#include <numbers>

#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

RowOptions rows_with(double azimuth, double radius) {
  RowOptions rows;
  rows.count = 4;
  rows.azimuth_deg = azimuth;
  rows.curve_radius_m = radius;
  return rows;
}

TEST(BlockGeometry, RowsRunAlongTheAzimuthAndCountToTheRight) {
  const BlockGeometry block(rows_with(90, 0));
  EXPECT_NEAR((block.row_point(0, 0) - Eigen::Vector2d(-13, 1.5 * 2.75)).norm(), 0, 1e-12);
  EXPECT_NEAR((block.row_point(3, 26) - Eigen::Vector2d(13, -1.5 * 2.75)).norm(), 0, 1e-12);
  EXPECT_DOUBLE_EQ(block.lane_lateral(0), block.row_lateral(0) - 1.375);
  EXPECT_DOUBLE_EQ(block.lane_lateral(4), block.row_lateral(3) + 1.375);
}

TEST(BlockGeometry, CurvedRowsAreArcsOfTheGivenRadiusAndLength) {
  for (const double radius : {60.0, -60.0}) {
    const BlockGeometry block(rows_with(0, radius));
    const Eigen::Vector2d center(radius, 0);
    for (int row = 0; row < 4; ++row) {
      const double expected = std::abs(radius - block.row_lateral(row));
      double length = 0;
      for (int i = 0; i < 2600; ++i) {
        const Eigen::Vector2d a = block.row_point(row, 0.01 * i), b = block.row_point(row, 0.01 * (i + 1));
        EXPECT_NEAR((a - center).norm(), expected, 1e-9);
        length += (b - a).norm();
      }
      EXPECT_NEAR(length, 26, 1e-4);
    }
  }
}

TEST(BlockGeometry, RowPositionInvertsRowPointOnStraightAndCurvedRows) {
  for (const double radius : {0.0, 45.0, -70.0}) {
    const BlockGeometry block(rows_with(33, radius));
    for (int row = 0; row < 4; ++row)
      for (const double chainage : {-2.0, 0.0, 7.3, 26.0, 29.5})
        for (const double offset : {-1.1, 0.0, 0.6}) {
          const Eigen::Vector2d direction = block.row_direction(row, chainage);
          const Eigen::Vector2d p =
              block.row_point(row, chainage) + offset * Eigen::Vector2d(direction.y(), -direction.x());
          const auto at = block.row_position(row, p);
          EXPECT_NEAR(at.chainage, chainage, 1e-9);
          EXPECT_NEAR(at.offset, offset, 1e-9);
          EXPECT_EQ(block.nearest_row(p), row);
        }
  }
}

TEST(Terrain, HasTheSlopeThatIsAskedFor) {
  Site site = bare_site();
  site.terrain.slope_percent = 8;
  site.terrain.slope_azimuth_deg = 60;
  const Terrain terrain(site);
  const Eigen::Vector2d uphill(std::sin(std::numbers::pi / 3), std::cos(std::numbers::pi / 3));
  EXPECT_NEAR(terrain.height(10 * uphill) - terrain.height(-10 * uphill), 1.6, 1e-5);
  EXPECT_NEAR(terrain.height(7 * Eigen::Vector2d(uphill.y(), -uphill.x())), 0, 1e-5);
}

TEST(Terrain, BanksCarryTheRowsAndHaveTheirWidthAtHalfHeight) {
  Site site = bare_site();
  site.terrain.bank_height_m = 0.2;
  site.terrain.bank_width_m = 0.8;
  const Terrain terrain(site);
  const BlockGeometry block(site.rows);
  const Eigen::Vector2d crest = block.row_point(1, 6);
  const Eigen::Vector2d along = block.row_direction(1, 6), right(along.y(), -along.x());
  EXPECT_NEAR(terrain.smooth_height(crest), 0.2, 1e-9);
  EXPECT_NEAR(terrain.smooth_height(crest + 0.4 * right), 0.1, 1e-9);
  EXPECT_NEAR(terrain.smooth_height(crest - 0.4 * right), 0.1, 1e-9);
  // The mesh follows within the sagitta of its 0.15 m cells.
  EXPECT_NEAR(terrain.height(crest), 0.2, 0.01);
}

TEST(Terrain, RoughnessHasItsStandardDeviation) {
  Site site = bare_site();
  site.rows.length_m = 60;
  site.rows.panel_length_m = 6;
  site.terrain.roughness_m = 0.02;
  const Terrain terrain(site);
  double squares = 0;
  int count = 0;
  for (double e = -25; e < 25; e += 0.9)
    for (double n = -10; n < 10; n += 0.9) squares += std::pow(terrain.height({e, n}), 2), ++count;
  // Linear interpolation inside the cells takes a little of the variance.
  EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.003);
}

}  // namespace
}  // namespace rayfield::sim
