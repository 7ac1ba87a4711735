#pragma once

#include <array>

#include "libdensity/echoes/full_echoes.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// Density of the leaf inclination (rad, 0…π/2), integral 1.
double leaf_inclination_density(const LeafAngles& angles, double inclination_rad);

/// Density of the normals of leaves that lie as the faces of ellipsoids `ratio` times as wide as high (Campbell 1986),
/// up to a factor, on the sphere; `up`: the normal's vertical component.
double ellipsoid_normals(double ratio, double up);

/// Projection function G(θ): mean area that one unit of one-sided leaf area shows to a ray of zenith angle θ
/// (Ross 1981; numerically integrated, relative error < 1e-4). 0.5 for spherical leaves at any θ.
double leaf_projection(const LeafAngles& angles, double cos_zenith);

/// Mean cosine of the angle between rays of that zenith angle and the normals of the leaves that they meet: leaves are
/// met in proportion to the cosine, so that it is that of its square over G(θ). kSphericalMeanCosine for spherical
/// leaves at any θ.
double mean_incidence_cosine(const LeafAngles& angles, double cos_zenith);

/// ln of the ratio of the axes of Campbell's ellipsoid, as measured; 0: leaves turned at random, more: flatter.
struct LnRatio {
  double value = 0, error = 0;  ///< standard error
  double weight() const { return 1 / (error * error); }
};

/// How the rays of a scan meet leaves turned somehow, in the mean over their hits.
struct LeafAspect {
  double mean_cosine = kSphericalMeanCosine;  ///< of the angle between rays and leaves' normals
  double apparent_side = 1;  ///< of leaves, where they are taken for turned at random; over the true one
};

/// leaf_projection() tabulated over |cos θ| with linear interpolation (error < 5e-4), for use once per ray.
class LeafProjectionTable {
 public:
  explicit LeafProjectionTable(const LeafAngles& angles);
  double operator()(double cos_zenith) const {
    const double u = (cos_zenith < 0 ? -cos_zenith : cos_zenith) * kCells;
    const int cell = u < kCells - 1 ? static_cast<int>(u) : kCells - 1;
    const auto i = static_cast<std::size_t>(cell);
    return values_[i] + (u - cell) * (values_[i + 1] - values_[i]);
  }

 private:
  static constexpr int kCells = 256;
  std::array<double, kCells + 1> values_{};
};

}  // namespace rayfield::density
