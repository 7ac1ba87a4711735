#pragma once

#include <array>
#include <string>
#include <string_view>

#include "rayfield/core/result.h"

namespace rayfield::density {

/// Distributions of leaf inclination (angle between a leaf's normal and the vertical; azimuths uniform).
/// de Wit's types plus Campbell's ellipsoid.
enum class LeafAngleType { spherical, uniform, planophile, erectophile, plagiophile, extremophile, ellipsoidal };

struct LeafAngles {
  LeafAngleType type = LeafAngleType::spherical;
  /// Ellipsoidal only: horizontal over vertical semi-axis; 1 = spherical, > 1 flatter leaves. Valid: 0.05…20.
  double ellipsoid_ratio = 1.0;
  Result<void> validate() const;
};

/// "spherical", "planophile" … Errors: usage.
Result<LeafAngleType> parse_leaf_angle_type(std::string_view name);
std::string_view leaf_angle_name(LeafAngleType type);

/// Density of the leaf inclination (rad, 0…π/2), integral 1.
double leaf_inclination_density(const LeafAngles& angles, double inclination_rad);

/// Projection function G(θ): mean area that one unit of one-sided leaf area shows to a ray of zenith angle θ
/// (Ross 1981; numerically integrated, relative error < 1e-4). 0.5 for spherical leaves at any θ.
double leaf_projection(const LeafAngles& angles, double cos_zenith);

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
