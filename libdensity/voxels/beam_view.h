#pragma once

#include <algorithm>
#include <limits>
#include <utility>

#include "libdensity/ground/sensor_track.h"
#include "rayfield/core/lidar_beam.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// Of the range resolution: an echo lies at its mean range and not at its beginning (docs/beams.md).
inline constexpr double kBehindResolutions = 0.8;

inline constexpr double kTypicalResolution_m = 0.15;

/// The range resolution that the options say, else that which is known of the beam, else a typical one, m.
inline double resolution_of(const LidarBeam& beam, const BeamOptions& options) {
  if (options.range_resolution_m > 0) return options.range_resolution_m;
  return beam.range_resolution_m.value_or(kTypicalResolution_m);
}

/// Beams of any width are followed so far, m: rows beside the lane are seen by some lidars' beams only wider.
inline constexpr double kFollowedAtLeast_m = 4;

/// How far from the lidar beams are followed, m: to where they get BeamOptions::widest_m wide, at most
/// BeamOptions::farthest_m, and at least 4 m.
inline double followed_of(const LidarBeam& beam, const BeamOptions& options) {
  const double narrow_m = beam.divergence_rad > 0 ? (options.widest_m - beam.diameter_m) / beam.divergence_rad
                                                  : std::numeric_limits<double>::infinity();
  return std::max(kFollowedAtLeast_m, std::min(narrow_m, options.farthest_m));
}

/// How the beams of a scan look at the voxels, where they are not thin.
struct BeamView {
  LidarBeam beam;
  double behind_m = 0;   ///< behind an echo, path of that part of the beam which is not in it (EchoCounters)
  SensorTrack track;     ///< of the scan
  double full_echo = 0;  ///< intensity of an echo that holds the whole beam, for DirectionCounters
  double followed_m = std::numeric_limits<double>::infinity();  ///< from the lidar; farther on beams are not looked at
};

/// How the beams that these options let be followed look at the voxels.
inline BeamView beam_view(const LidarBeam& beam, SensorTrack track, const BeamOptions& options) {
  return {beam, kBehindResolutions * resolution_of(beam, options), std::move(track), 0, followed_of(beam, options)};
}

}  // namespace rayfield::density
