#pragma once

#include <Eigen/Core>
#include <array>

#include "rayfield/core/map_frame.h"
#include "rayfield/core/rigid3.h"
#include "rayfield/sim/world.h"

namespace rayfield::sim {

/// Local ENU → map coordinates as a second-order expansion about the ENU origin, checked against PROJ when it is made.
/// Thread-safe, unlike MapFrame, and fast enough for every ray.
class MapFromEnu {
 public:
  /// Checks that the expansion differs from the exact map by at most 0.1 mm within ±`reach_m` horizontally and ±30 m
  /// vertically. Errors: usage (CRS not usable, or the site too large for it).
  static Result<MapFromEnu> create(const Site& site, double reach_m);

  Eigen::Vector3d operator()(const Eigen::Vector3d& p_in_enu) const {
    Eigen::Vector3d q = value_ + jacobian_ * p_in_enu;
    for (std::size_t axis = 0; axis < 3; ++axis)
      q[static_cast<Eigen::Index>(axis)] += 0.5 * p_in_enu.dot(hessian_[axis] * p_in_enu);
    return q;
  }
  /// A pose in the map: position as above, orientation relative to grid east, grid north and the local vertical.
  Rigid3 operator()(const Rigid3& enu_from_body) const;

 private:
  Eigen::Vector3d value_;
  Eigen::Matrix3d jacobian_;
  std::array<Eigen::Matrix3d, 3> hessian_;
};

/// Horizontal distance from the origin that no ray of the site exceeds, m.
double site_reach_m(const World& world);

}  // namespace rayfield::sim
