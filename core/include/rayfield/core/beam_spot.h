#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace rayfield {

/// What lies above is spared: 1 m is more than any lidar's.
inline constexpr double kMaxRangeResolution_m = 1;

/// By how much a spot `spot_depth_m` deep along the beam seems nearer than its middle, where only what lies within
/// `resolution_m` of its near edge makes the echo. Both m; ≥ 0. For a disc of even brightness on a plane.
double spot_shift_m(double spot_depth_m, double resolution_m);

/// A plane that a wide beam meets aslant, against where it is.
struct SpotLift {
  double spot_depth_m = 0;   ///< of the beam's spot on it, along the beam
  double cos_incidence = 1;  ///< of the angle between the beam and the plane's normal
  double lift_m = 0;         ///< along the normal, towards the lidar
};

/// How far apart along the beam two surfaces may lie and still make one echo.
struct RangeResolution {
  double value_m = 0;
  double sigma_m = 0;       ///< from how sections of the lifts differ
  std::uint64_t pairs = 0;  ///< number of lifts
};

/// That which explains the lifts with the least mean absolute misfit, each up to 9 mm, to 3 %; kMaxRangeResolution_m
/// where no echo came too early. Neighbours among `lifts` should be alike: sections of them tell the error.
RangeResolution fit_range_resolution(std::span<const SpotLift> lifts);

/// A fit less `unnoticed_m`: a spot a little deeper than the resolution loses nothing but its dim edge. Nothing where
/// no echo came too early, or where sections differ by more than `max_relative_sigma` of it.
std::optional<RangeResolution> believed(const RangeResolution& fit, double unnoticed_m, double max_relative_sigma);

}  // namespace rayfield
