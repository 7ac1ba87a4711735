#pragma once

#include <optional>

namespace rayfield {

inline constexpr double kWidestBeam_m = 0.2, kWidestDivergence_rad = 0.1;
inline constexpr double kFinestRange_m = 0.005, kCoarsestRange_m = 2;  // range resolutions

/// The beam of a lidar: a disc of diameter_m + divergence_rad · range.
struct LidarBeam {
  double diameter_m = 0;      ///< where it leaves the lidar, up to kWidestBeam_m
  double divergence_rad = 0;  ///< full angle; of an elliptical beam the geometric mean of both
  /// Share of the beam's energy that has to fall on leaves within the range resolution to make a return, up to 1.
  /// No data sheet states it. Absent: not known.
  std::optional<double> detection_share;
  /// Surfaces closer together along the beam than this make one echo, up to kCoarsestRange_m. Stated in the rig or
  /// measured from a drive. Absent: not known.
  std::optional<double> range_resolution_m;

  double diameter_at(double range_m) const { return diameter_m + divergence_rad * range_m; }
  bool same_disc(const LidarBeam& other) const {
    return diameter_m == other.diameter_m && divergence_rad == other.divergence_rad;
  }
  friend bool operator==(const LidarBeam&, const LidarBeam&) = default;
};

}  // namespace rayfield
