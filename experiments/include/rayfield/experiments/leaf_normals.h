#pragma once

#include <Eigen/Core>

namespace rayfield::experiments {

/// How a leaf normal is drawn "from an ellipsoid of the given dimensions" (the paper's table of trawling and spinning
/// lidar, which does not say more): a point evenly in a body, times the dimensions, normalised.
enum class NormalBody {
  sphere,  ///< evenly on the unit sphere
  cube,    ///< evenly in the cube from −1 to 1: gives the paper's figures for spinning lidar
};

struct LeafNormals {
  Eigen::Vector3d eccentricity = Eigen::Vector3d::Ones();  ///< dimensions along x, y (horizontal) and z (up)
  NormalBody body = NormalBody::sphere;
};

}  // namespace rayfield::experiments
