#pragma once

#include "libdensity/ground/sensor_track.h"
#include "rayfield/core/lidar_beam.h"

namespace rayfield::density {

/// Of the range resolution: an echo lies at its mean range and not at its beginning (BEHIND in echo_loss.py).
inline constexpr double kBehindResolutions = 0.8;

/// How the beams of a scan look at the voxels, where they are not thin.
struct BeamView {
  LidarBeam beam;
  double behind_m = 0;  ///< behind an echo, path of that part of the beam which is not in it (EchoCounters)
  SensorTrack track;    ///< of the scan
};

}  // namespace rayfield::density
