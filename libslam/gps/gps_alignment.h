/// gps: position fixes: alignment of a trajectory with them, their clock, and the way into the map frame.
#pragma once

#include <Eigen/Core>
#include <span>

#include "libslam/trajectory/pose_track.h"
#include "rayfield/core/rigid3.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/slam/options.h"

namespace rayfield::slam {

/// A fix in the local tangent plane on the drive's clock.
struct GpsPosition {
  double time_s = 0;  ///< after the epoch, IMU clock
  Eigen::Vector3d enu = Eigen::Vector3d::Zero();
  double sigma_horizontal_m = 1, sigma_vertical_m = 1;  ///< of one fix as the receiver states it, floored
};

/// Yaw and translation that bring the trajectory onto the fixes (H of the paper, restricted: roll and pitch come from
/// gravity), robust against jumps: Cauchy weights at the median residual.
struct GpsAlignment {
  bool solved = false;
  Rigid3 enu_from_world;         ///< a rotation about z and a translation
  double baseline_m = 0;         ///< largest horizontal extent of the used track
  double median_residual_m = 0;  ///< horizontal, after alignment
  double yaw_sigma_rad = 0;      ///< from the residuals, with their correlation time
};

/// `track` gives the IMU pose; fixes outside its time are ignored.
GpsAlignment align_to_gps(const PoseTrack& track, std::span<const GpsPosition> fixes,
                          const Eigen::Vector3d& lever_arm_m, const GpsOptions& options);

/// The time by which GPS stamps are early: added to them it brings the fixes onto the track's clock.
struct GpsOffsetFit {
  bool solved = false;
  double offset_s = 0, sigma_s = 0;
};

/// Least squares over differences of the offset across two seconds: e(t+2) − e(t) = −(v(t+2) − v(t))·offset. A bias
/// that wanders slowly cancels in them; the information comes from the change of velocity in turns. `track` is already
/// aligned. Not solved where the drive has no turn. Robust against jumps.
GpsOffsetFit fit_gps_offset(const PoseTrack& track, std::span<const GpsPosition> fixes,
                            const Eigen::Vector3d& lever_arm_m);

/// Moves every pose: pose ← transform · pose.
void transform_track(PoseTrack& track, const Rigid3& transform);

}  // namespace rayfield::slam
