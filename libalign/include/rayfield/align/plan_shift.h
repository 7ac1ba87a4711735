#pragma once

#include <Eigen/Core>
#include <cmath>

namespace rayfield::align {

/// A turn about the vertical through `pivot` and a shift: p ↦ R(yaw)·(p − pivot) + pivot + shift, in map coordinates
/// (easting, northing, height; m). yaw counts from east to north.
struct PlanShift {
  Eigen::Vector2d pivot = Eigen::Vector2d::Zero();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double yaw_rad = 0;

  Eigen::Vector2d turned(const Eigen::Vector2d& direction) const {
    const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
    return {c * direction.x() - s * direction.y(), s * direction.x() + c * direction.y()};
  }
  Eigen::Vector2d operator*(const Eigen::Vector2d& p) const { return turned(p - pivot) + pivot + shift.head<2>(); }
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const {
    const Eigen::Vector2d plan = *this * Eigen::Vector2d(p.head<2>());
    return {plan.x(), plan.y(), p.z() + shift.z()};
  }
};

}  // namespace rayfield::align
