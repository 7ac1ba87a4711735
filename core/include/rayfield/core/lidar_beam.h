#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace rayfield {

inline constexpr double kWidestBeam_m = 0.2, kWidestDivergence_rad = 0.1;
inline constexpr double kFinestRange_m = 0.005, kCoarsestRange_m = 2;  // range resolutions

/// Which echo of a beam the lidar reports.
enum class ReturnMode { first, strongest, last };

inline constexpr std::array<std::pair<std::string_view, ReturnMode>, 3> kReturnModes{
    {{"first", ReturnMode::first}, {"strongest", ReturnMode::strongest}, {"last", ReturnMode::last}}};

inline std::string_view name_of(ReturnMode mode) {
  for (const auto& [name, known] : kReturnModes)
    if (known == mode) return name;
  return {};
}

inline std::optional<ReturnMode> return_mode_named(std::string_view name) {
  for (const auto& [known, mode] : kReturnModes)
    if (known == name) return mode;
  return std::nullopt;
}

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
  /// Of beams with several echoes. Absent: not known.
  std::optional<ReturnMode> returns;

  double diameter_at(double range_m) const { return diameter_m + divergence_rad * range_m; }
  bool same_disc(const LidarBeam& other) const {
    return diameter_m == other.diameter_m && divergence_rad == other.divergence_rad;
  }
  friend bool operator==(const LidarBeam&, const LidarBeam&) = default;
};

}  // namespace rayfield
