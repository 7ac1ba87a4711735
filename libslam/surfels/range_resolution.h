#pragma once

#include <optional>
#include <span>

#include "libslam/surfels/surfel.h"
#include "libslam/surfels/surfel_file.h"
#include "libslam/trajectory/pose_track.h"
#include "rayfield/core/beam_spot.h"

/// How far apart along the beam two surfaces may lie and still make one echo, from ground that a wide beam meets first
/// aslant and then steeply.
namespace rayfield::slam {

/// Measured on the surfels of stage a, extracted without a limit of their spots' depth; `track` must be near enough to
/// level that ground is within 20° of it. Nothing where fewer than 200 pairs have spots deeper than 0.1 m: thin beams,
/// no ground. kMaxRangeResolution_m where no echo came too early.
Result<std::optional<RangeResolution>> measure_range_resolution(const SurfelFile& surfels, const PoseTrack& track,
                                                                const BeamSource& source,
                                                                std::span<const double> voxel_size_m);

}  // namespace rayfield::slam
