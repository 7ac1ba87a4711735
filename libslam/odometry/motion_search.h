#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <utility>

#include "libslam/surfels/surfel.h"
#include "libslam/trajectory/pose_track.h"

namespace rayfield::slam {

/// Motion over the first seconds as a quadratic in time: p(t) = rowᵀ·(1, t, t²), columns x y z.
using QuadraticMotion = Eigen::Matrix3d;

/// The quadratic that fits positions at times best (least squares). At least three different times are needed.
QuadraticMotion fit_quadratic(std::span<const std::pair<double, Eigen::Vector3d>> samples);

/// Position of a quadratic motion at a time.
Eigen::Vector3d quadratic_at(const QuadraticMotion& motion, double time_s);

/// The motion of a drive that began in motion, in the levelled frame of `track` (yaw zero at the first pose),
/// less its value at time zero. `track` holds rotations and the shaking of the vehicle: integrated IMU positions
/// without their best quadratic, which at that point is made of unknown tilt, bias and velocity. With `gps` (quadratic
/// of the fixes, ENU) only the heading is unknown: all headings are tried, then the velocity is refined. Without,
/// velocities up to `max_speed` m/s in the plane of the vehicle's floor are tried. The best
/// motion is the one under which most points above the ground meet points of the sweep (about two seconds) before.
QuadraticMotion search_motion(std::span<const BodyPoint> points, const PoseTrack& track,
                              const std::optional<QuadraticMotion>& gps, const Eigen::Vector3d& gps_arm_m,
                              double max_speed, int threads);

}  // namespace rayfield::slam
