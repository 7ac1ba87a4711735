#pragma once

#include <optional>

namespace rayfield {

inline constexpr double kWidestBeam_m = 0.2, kWidestDivergence_rad = 0.1;

/// The beam of a lidar: a disc of diameter_m + divergence_rad · range.
struct LidarBeam {
  double diameter_m = 0;      ///< where it leaves the lidar, up to kWidestBeam_m
  double divergence_rad = 0;  ///< full angle; of an elliptical beam the geometric mean of both
  /// Share of the beam's energy that has to fall on leaves within the range resolution to make a return, up to 1.
  /// No data sheet tells it: absent, it is not known.
  std::optional<double> detection_share;

  double diameter_at(double range_m) const { return diameter_m + divergence_rad * range_m; }
  friend bool operator==(const LidarBeam&, const LidarBeam&) = default;
};

}  // namespace rayfield
