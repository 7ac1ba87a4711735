#pragma once

#include <Eigen/Core>
#include <vector>

namespace rayfield::align {

/// A smooth displacement over the plan: a uniform bicubic B-spline. Beyond its lattice it keeps the value at the
/// border, so that the far ends of rays move like the edge of the block.
struct Warp {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< where the first knot span begins, map m
  double spacing_m = 0;
  int nx = 0, ny = 0;                    ///< control points
  std::vector<Eigen::Vector3d> control;  ///< displacement (east, north, up), m; index iy·nx + ix; empty: none

  bool empty() const { return control.empty(); }
  Eigen::Vector3d at(const Eigen::Vector2d& p) const;
};

/// The sixteen control points that a place depends on, and their weights.
struct WarpWeights {
  int first_x = 0, first_y = 0;  ///< of the 4 × 4
  double x[4] = {}, y[4] = {};
};
WarpWeights warp_weights(const Warp& warp, const Eigen::Vector2d& p);

}  // namespace rayfield::align
