#pragma once

#include <Eigen/Core>
#include <vector>

#include "rayfield/sim/random.h"
#include "rayfield/sim/site.h"

namespace rayfield::sim {

/// Draws leaf normals whose zenith angle follows a leaf-angle distribution, uniform in azimuth.
class LeafNormals {
 public:
  explicit LeafNormals(LeafAngles angles, double ellipsoid_ratio = 1);
  /// A unit normal in the upper half space; two draws.
  Eigen::Vector3d draw(CounterRandom& random) const;

 private:
  std::vector<double> zenith_;  ///< quantiles of the zenith angle at equal steps of probability, rad
};

/// Probability density of the zenith angle θ ∈ [0, π/2] between leaf normal and vertical, up to a constant factor (de
/// Wit 1965, Goel and Strebel 1984; ellipsoidal: Campbell 1990, sin θ / (cos²θ + χ² sin²θ)²).
double leaf_zenith_density(LeafAngles angles, double ellipsoid_ratio, double zenith_rad);

}  // namespace rayfield::sim
