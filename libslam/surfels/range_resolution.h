#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "libslam/surfels/surfel.h"
#include "libslam/surfels/surfel_file.h"
#include "libslam/trajectory/pose_track.h"

/// How far apart along the beam two surfaces may lie and still make one echo, from ground that a wide beam meets first
/// aslant and then steeply.
namespace rayfield::slam {

struct RangeResolution {
  double value_m = 0;
  double sigma_m = 0;       ///< from how sections of the drive differ
  std::uint64_t pairs = 0;  ///< of ground seen aslant and steeply
};

/// What lies above is spared: 1 m is more than any lidar's.
inline constexpr double kMaxRangeResolution_m = 1;

/// By how much a spot `spot_depth_m` deep along the beam seems nearer than its middle, where only what lies within
/// `resolution_m` of its near edge makes the echo. Both m; ≥ 0. For a disc of even brightness on a plane.
double spot_shift_m(double spot_depth_m, double resolution_m);

/// Measured on the surfels of stage a, extracted without a limit of their spots' depth; `track` must be near enough to
/// level that ground is within 20° of it. Nothing where fewer than 200 pairs have spots deeper than 0.1 m: thin beams,
/// no ground. kMaxRangeResolution_m where no echo came too early.
Result<std::optional<RangeResolution>> measure_range_resolution(const SurfelFile& surfels, const PoseTrack& track,
                                                                const BeamSource& source,
                                                                std::span<const double> voxel_size_m);

}  // namespace rayfield::slam
