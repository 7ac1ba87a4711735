#pragma once

#include <Eigen/Core>
#include <vector>

#include "rayfield/sim/site.h"

namespace rayfield::sim {

/// The shots of one lidar message: directions in the lidar frame and times from its stamp.
struct BeamPattern {
  std::vector<Eigen::Vector3f> direction;
  std::vector<float> time_offset_s;
  double period_s = 0;  ///< from message to message
};

/// A spun 2-D scanner sweeps its x–y plane from −fov/2 to +fov/2; a multi-beam one turns anticlockwise about z from x,
/// all beams of an azimuth at once, lowest first.
BeamPattern beam_pattern(const Site& site);

/// True angle of the spinner `t` seconds after the start of the log, rad, not wrapped.
double spinner_angle(const SiteSpinning& spinning, double t);

}  // namespace rayfield::sim
