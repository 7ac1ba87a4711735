/// trajectory: poses on a time grid, the spline that corrects them, rotations, and the result in map coordinates.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "libslam/trajectory/so3.h"
#include "rayfield/core/rigid3.h"

namespace rayfield::slam {

/// Poses of the IMU on a uniform time grid: pose k at k·step_s seconds after the epoch of the drive.
/// The trajectory that both stages correct. Between grid times: linear in position, along the geodesic in rotation.
struct PoseTrack {
  double step_s = 0.01;
  std::vector<Eigen::Quaterniond> rotation;  ///< world_from_imu
  std::vector<Eigen::Vector3d> position;     ///< of the IMU in the world, m

  int size() const { return static_cast<int>(position.size()); }
  double end_s() const { return (size() - 1) * step_s; }

  /// Grid index at or below a time, so that index+1 exists too (size() ≥ 2).
  int floor_index(double time_s) const {
    return std::clamp(static_cast<int>(std::floor(time_s / step_s)), 0, size() - 2);
  }

  Rigid3 pose(double time_s) const {
    const int k = floor_index(time_s);
    const double f = time_s / step_s - k;
    return {between(rotation[k], rotation[k + 1], f), (1 - f) * position[k] + f * position[k + 1]};
  }

  /// Velocity in the world, m/s.
  Eigen::Vector3d velocity(double time_s) const {
    const int k = floor_index(time_s);
    return (position[k + 1] - position[k]) / step_s;
  }

  /// Angular velocity in the world, rad/s.
  Eigen::Vector3d angular_velocity(double time_s) const {
    const int k = floor_index(time_s);
    return log_so3(rotation[k + 1] * rotation[k].conjugate()) / step_s;
  }
};

}  // namespace rayfield::slam
