#pragma once

#include <optional>

#include "libdensity/echoes/echo_statistics.h"
#include "rayfield/core/lidar_beam.h"

namespace rayfield::density {

/// What the echoes of a scan mean where its beam is not thin (docs/beams.md, "How it is taken out").
struct EchoModel {
  LidarBeam beam;
  double range_resolution_m = 0;
  double full_echo = 0;        ///< mean intensity of an echo of leaves that take the whole beam
  double detection_share = 0;  ///< weakest echo, in full ones
  double leaf_area_m2 = 0;     ///< of one leaf
  bool leaf_measured = false;  ///< false: too few pairs of neighbouring beams, the default
  double full_echo_error = 0;  ///< relative standard error
  double echo_variation = 0;   ///< variance of the echoes' intensities over the square of their mean
  double mean_width_m = 0;     ///< of the beams where they met leaves
};

/// What is known beforehand.
struct EchoKnowledge {
  LidarBeam beam;
  double range_resolution_m = 0.15;
  double full_echo = 0;         ///< 0: from the statistics
  double leaf_area_m2 = -1;     ///< negative: from the statistics
};

/// Nothing where the echoes do not tell: too few, or all of one intensity.
///
/// Full echo: the mean echo drawn out linearly over the beam's width to a width of 0 (a thin ray's echo is a full one
/// whatever it meets), and the mean of inner echoes (EchoRun) of the narrowest third, weighted by the inverse variance of
/// what either is known to be off by. Detection share: where echoes set in, at half of the greatest number per unit of
/// intensity. Leaves: estimate_leaf_size() of pairs of at least half a full echo, whose side is too large by 1 + (D/54
/// mm)^1.5, D the mean width; both numbers were fitted to seven simulated scans of one kind of canopy, with leaves of 59
/// to 126 mm and beams of 15 and 37 mm (docs/beams.md).
std::optional<EchoModel> estimate_echo_model(const EchoStatistics& statistics, const EchoKnowledge& known);

}  // namespace rayfield::density
