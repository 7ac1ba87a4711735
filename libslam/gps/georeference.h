#pragma once

#include <optional>
#include <span>
#include <vector>

#include "libslam/gps/gps_alignment.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/slam/trajectory.h"

namespace rayfield::slam {

/// Whether a message holds a position: a fix, finite, within the range of coordinates, not the zero that some drivers
/// send before the first fix.
bool usable_fix(const GpsFix& fix);

/// Fixes of a drive in a tangent plane at their median, and how many were rejected.
struct GpsTrack {
  std::optional<TangentPlane> plane;
  std::vector<GpsPosition> positions;
  std::uint64_t invalid = 0;  ///< no fix, not finite, or outside the range of coordinates
};

/// Fixes within [start, end] (Unix s, IMU clock after rig.gps_offset_s), on the drive's clock. A covariance that is not
/// known or not plausible counts as 2 m; all are floored by options.min_sigma_m.
GpsTrack collect_fixes(std::span<const GpsFix> fixes, const Rig& rig, double start_s, double end_s, double epoch_s,
                       const GpsOptions& options);

/// Poses in the tangent plane → map frame. Every position goes through the projection; rotation (convergence and the
/// tilt between the plane's up and the local one) and scale are taken every 50 m, where they differ by under 1e-5.
Trajectory map_trajectory(const PoseTrack& track, double epoch_s, const TangentPlane& plane, const MapFrame& frame);

/// Poses as they are, in a local frame.
Trajectory local_trajectory(const PoseTrack& track, double epoch_s);

}  // namespace rayfield::slam
