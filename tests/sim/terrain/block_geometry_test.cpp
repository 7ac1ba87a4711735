#include "sim/terrain/block_geometry.h"

#include <cmath>

#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

SiteRows rows_with(double azimuth, double radius) {
  SiteRows rows;
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

}  // namespace
}  // namespace rayfield::sim
