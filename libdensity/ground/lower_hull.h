#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::density {

/// A triangulated surface below points.
struct LowerHull {
  std::vector<std::array<int, 3>> triangles;  ///< indices of the input points, counter-clockwise in plan
};

/// Lower convex hull of the points lifted by k(x²+y²) about their centre (Qhull, option Qt). Points that are not finite
/// are left out. Errors: bad_input when the finite points do not span a volume after lifting (fewer than four,
/// collinear in plan, or all on one paraboloid); the reason says which.
Result<LowerHull> lower_hull(std::span<const Eigen::Vector3d> points, double curvature_per_m);

}  // namespace rayfield::density
