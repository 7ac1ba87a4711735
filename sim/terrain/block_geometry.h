#pragma once

#include <Eigen/Core>

#include "rayfield/sim/site.h"

namespace rayfield::sim {

/// Where rows and lanes lie, in plan. All points are east, north in metres from the block's centre (the ENU origin).
/// Rows are numbered 0 … count-1 from left to right when looking along the azimuth; lane i runs left of row i and lane
/// `count` right of the last row. A row or lane is an arc (or a straight line) at a lateral offset from the block's
/// centreline; `along` is the distance on that arc from mid-length, chainage the distance from the row's start.
class BlockGeometry {
 public:
  explicit BlockGeometry(const SiteRows& rows);

  int row_count() const { return rows_.count; }
  double row_length() const { return rows_.length_m; }
  double row_lateral(int row) const { return (row - 0.5 * (rows_.count - 1)) * rows_.spacing_m; }
  double lane_lateral(int lane) const { return (lane - 0.5 * rows_.count) * rows_.spacing_m; }

  /// The point `along` m from mid-length on the line at `lateral` (m, right positive). Lines go on straight beyond
  /// their ends (|along| > length / 2).
  Eigen::Vector2d point(double lateral, double along) const;
  /// Unit tangent there, in the direction of growing `along`.
  Eigen::Vector2d direction(double lateral, double along) const;

  Eigen::Vector2d row_point(int row, double chainage) const {
    return point(row_lateral(row), chainage - 0.5 * rows_.length_m);
  }
  Eigen::Vector2d row_direction(int row, double chainage) const {
    return direction(row_lateral(row), chainage - 0.5 * rows_.length_m);
  }

  /// Chainage along `row` (not clamped) and offset from its centreline, right positive. Inverse of row_point() plus an
  /// offset to the right, exact everywhere on the right side of the centre of curvature.
  struct RowPosition {
    double chainage = 0, offset = 0;
  };
  RowPosition row_position(int row, const Eigen::Vector2d& p) const;
  /// The row whose centreline is nearest, with the position along it.
  int nearest_row(const Eigen::Vector2d& p) const;

  /// Block frame: u along the azimuth, v to the right of it.
  Eigen::Vector2d enu_from_block(const Eigen::Vector2d& uv) const;
  Eigen::Vector2d block_from_enu(const Eigen::Vector2d& en) const;
  /// Half extents in u and v of all rows, about the origin.
  Eigen::Vector2d half_extent() const { return half_extent_; }

 private:
  SiteRows rows_;
  double sin_azimuth_, cos_azimuth_;
  double curvature_;  ///< 1 / radius, 0 for straight rows
  Eigen::Vector2d half_extent_;

  Eigen::Vector2d block_point(double lateral, double along) const;
  double heading_in_block(double lateral, double along) const;
  RowPosition position_from(double lateral, const Eigen::Vector2d& uv) const;
};

}  // namespace rayfield::sim
