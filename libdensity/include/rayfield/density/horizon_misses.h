#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace rayfield::density {

/// Rays without a return up to 15° above and below the horizon: most clouds leave the downward ones out.
struct HorizonMisses {
  std::int64_t above = 0, below = 0;

  /// `way`: of a ray without a return, of any length.
  void add(const Eigen::Vector3d& way) {
    constexpr double kLevel = 0.26;  // sine of 15°
    if (way.z() == 0 || !(std::abs(way.z()) <= kLevel * way.norm())) return;
    ++(way.z() > 0 ? above : below);
  }
  HorizonMisses& operator+=(const HorizonMisses& other) {
    above += other.above, below += other.below;
    return *this;
  }
  /// Whether downward ones are there. A fiftieth of the upward ones is more than a cloud that dropped them can have by
  /// a tilt of its frame, and less than any lidar of 100 m range or less on level ground keeps.
  bool holds_downward() const { return below > 0 && 50 * below >= above; }
  bool operator==(const HorizonMisses&) const = default;
};

}  // namespace rayfield::density
