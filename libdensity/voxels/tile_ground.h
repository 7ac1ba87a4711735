#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>

#include "libdensity/layout/row_layout.h"

namespace rayfield::density {

/// The ground of a tile as one plane: least squares through the ground under the row segments.
struct TileGround {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< per metre east and north

  static TileGround of(std::span<const RowSegment> row_segments);

  double height_of(const Eigen::Vector3d& p) const {
    return p.z() - center.z() - slope.dot(p.head<2>() - center.head<2>());
  }
  /// Within what undulation and grass make of the plane.
  bool is_near(const Eigen::Vector3d& p) const { return std::abs(height_of(p)) < 0.3; }
  /// Of a unit direction to the normal, without sign.
  double cosine_to(const Eigen::Vector3d& d) const {
    return std::abs(slope.dot(d.head<2>()) - d.z()) / std::sqrt(1 + slope.squaredNorm());
  }

  /// Whether a ray that goes on from p in the unit direction d is sure to come back: it goes up (and is kept without a
  /// return) or meets the ground within `reach_m`, even if that falls away by `margin` more than the plane.
  bool sure_to_return(const Eigen::Vector3d& p, const Eigen::Vector3d& d, double reach_m, double margin) const {
    if (d.z() > 0) return true;
    const double descent = slope.dot(d.head<2>()) - d.z() - margin;
    return descent > 0 && height_of(p) <= descent * reach_m;
  }
};

}  // namespace rayfield::density
