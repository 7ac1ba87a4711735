#pragma once

#include <Eigen/Core>
#include <vector>

#include "libdensity/ground/ground_model.h"
#include "libdensity/layout/row_layout.h"

namespace rayfield::density {

/// A post or a trunk as a circular cylinder in map coordinates.
struct WoodCylinder {
  int row = 0;                                      ///< Row::number
  Eigen::Vector3d base = Eigen::Vector3d::Zero();   ///< on its axis, at the ground
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit, upwards
  double radius_m = 0.05;
  double length_m = 0;  ///< from base to top along the axis
  double bend_m = 0;    ///< how far the true axis may stray from this one; widens what is masked, not its surface
  /// Posts stand straight.
  bool is_trunk() const { return bend_m > 0; }
};

/// Posts and trunks of the layout as cylinders that stand on the ground: posts with their lean, trunks upright, with 2
/// cm of bend. Posts that were only placed by regular spacing are left out (nothing was seen there), and what stands on
/// unknown ground.
std::vector<WoodCylinder> wood_of(const RowLayout& layout, const GroundModel& ground);

/// How far the straight line origin + t·direction passes from the cylinder's axis.
double distance_from_axis(const WoodCylinder& wood, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// Where the straight line origin + t·direction runs inside the cylinder widened by `shell_m` and its bend in radius,
/// and by `shell_m` at its top (downwards it is unbounded, into the ground). False when it misses. t in units of
/// |direction|.
bool shell_interval(const WoodCylinder& wood, double shell_m, const Eigen::Vector3d& origin,
                    const Eigen::Vector3d& direction, double& t_in, double& t_out);

/// Whether a point lies in that widened cylinder.
bool in_shell(const WoodCylinder& wood, double shell_m, const Eigen::Vector3d& p_in_map);

}  // namespace rayfield::density
