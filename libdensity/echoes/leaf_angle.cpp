#include "libdensity/echoes/leaf_angle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rayfield::density {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kQuadraturePoints = 2000;  // midpoint rule; G is continuous with bounded slope in the inclination

double ellipsoid_shape(double ratio, double inclination_rad) {
  return std::sin(inclination_rad) * ellipsoid_normals(ratio, std::cos(inclination_rad));
}

double ellipsoid_norm(double ratio) {
  double sum = 0;
  const double step = kPi / 2 / kQuadraturePoints;
  for (int i = 0; i < kQuadraturePoints; ++i) sum += ellipsoid_shape(ratio, (i + 0.5) * step) * step;
  return sum;
}

/// Warren Wilson's kernel: projection of a leaf of that inclination, averaged over its azimuth, on a plane across a
/// ray of that zenith angle.
double azimuth_mean_projection(double zenith_rad, double inclination_rad) {
  const double cc = std::cos(zenith_rad) * std::cos(inclination_rad);
  const double ss = std::sin(zenith_rad) * std::sin(inclination_rad);
  if (cc >= ss) return cc;
  // cc·(1 + 2/π·(tan ψ − ψ)) with cos ψ = cc/ss, in a form that stays finite for horizontal rays.
  return cc + 2 / kPi * (std::sqrt(ss * ss - cc * cc) - cc * std::acos(cc / ss));
}

}  // namespace

double ellipsoid_normals(double ratio, double up) {
  const double q = up * up + ratio * ratio * (1 - up * up);
  return 1 / (q * q);
}

double leaf_inclination_density(const LeafAngles& angles, double inclination_rad) {
  switch (angles.type) {
    case LeafAngleType::spherical:
    case LeafAngleType::measured:
      return std::sin(inclination_rad);
    case LeafAngleType::uniform:
      return 2 / kPi;
    case LeafAngleType::planophile:
      return 2 / kPi * (1 + std::cos(2 * inclination_rad));
    case LeafAngleType::erectophile:
      return 2 / kPi * (1 - std::cos(2 * inclination_rad));
    case LeafAngleType::plagiophile:
      return 2 / kPi * (1 - std::cos(4 * inclination_rad));
    case LeafAngleType::extremophile:
      return 2 / kPi * (1 + std::cos(4 * inclination_rad));
    case LeafAngleType::ellipsoidal:
      return ellipsoid_shape(angles.ellipsoid_ratio, inclination_rad) / ellipsoid_norm(angles.ellipsoid_ratio);
  }
  return 0;
}

double leaf_projection(const LeafAngles& angles, double cos_zenith) {
  if (angles.type == LeafAngleType::spherical || angles.type == LeafAngleType::measured) return 0.5;
  const double zenith = std::acos(std::clamp(std::abs(cos_zenith), 0.0, 1.0));
  const bool ellipsoid = angles.type == LeafAngleType::ellipsoidal;
  const double norm = ellipsoid ? ellipsoid_norm(angles.ellipsoid_ratio) : 1.0;
  const double step = kPi / 2 / kQuadraturePoints;
  double sum = 0;
  for (int i = 0; i < kQuadraturePoints; ++i) {
    const double inclination = (i + 0.5) * step;
    const double density = ellipsoid ? ellipsoid_shape(angles.ellipsoid_ratio, inclination) / norm
                                     : leaf_inclination_density(angles, inclination);
    sum += azimuth_mean_projection(zenith, inclination) * density * step;
  }
  return sum;
}

double mean_incidence_cosine(const LeafAngles& angles, double cos_zenith) {
  const double step = kPi / 2 / kQuadraturePoints;
  const bool ellipsoid = angles.type == LeafAngleType::ellipsoidal;
  double squares = 0, sum = 0;  // of the cosine of the inclination, by a density without its constant
  for (int i = 0; i < kQuadraturePoints; ++i) {
    const double inclination = (i + 0.5) * step;
    const double density = ellipsoid ? ellipsoid_shape(angles.ellipsoid_ratio, inclination)
                                     : leaf_inclination_density(angles, inclination);
    squares += std::cos(inclination) * std::cos(inclination) * density, sum += density;
  }
  const double upright = squares / sum;
  const double up = cos_zenith * cos_zenith;
  return (up * upright + (1 - up) * (1 - upright) / 2) / leaf_projection(angles, cos_zenith);
}

LeafProjectionTable::LeafProjectionTable(const LeafAngles& angles) {
  for (int i = 0; i <= kCells; ++i) values_[i] = leaf_projection(angles, static_cast<double>(i) / kCells);
}

}  // namespace rayfield::density
