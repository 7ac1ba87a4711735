#pragma once

#include <Eigen/Core>

#include "rayfield/core/rigid3.h"
#include "sim/drive/uniform_spline.h"

namespace rayfield::sim {

inline constexpr double kGravity = 9.81;  ///< m/s², down along the ENU z axis

/// Pose of the IMU and its exact derivatives.
struct Motion {
  Rigid3 enu_from_imu;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< in ENU, m/s
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      ///< in ENU, m/s²
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< in the IMU frame, rad/s

  /// What an ideal accelerometer reads: Rᵀ(a + g·ẑ), m/s².
  Eigen::Vector3d specific_force() const;
};

/// The true path of the IMU as smooth functions of time (quintic splines of position and of yaw, pitch, roll), so that
/// poses, angular velocities and accelerations agree to rounding.
class TrueTrajectory {
 public:
  /// East, north, up (m), yaw (continuous, anticlockwise from east), pitch (nose down positive), roll (left up
  /// positive).
  using Spline = UniformSpline<6>;

  TrueTrajectory() = default;
  explicit TrueTrajectory(Spline spline) : spline_(std::move(spline)) {}

  /// Seconds from the start of the log.
  double duration() const { return spline_.end(); }
  Motion motion(double t) const;
  /// Rotation matrix ENU from IMU and position; what rays need, faster than motion().
  struct PoseMatrix {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
  };
  PoseMatrix pose(double t) const;

 private:
  Spline spline_;
};

}  // namespace rayfield::sim
