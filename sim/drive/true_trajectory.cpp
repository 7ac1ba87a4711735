#include "sim/drive/true_trajectory.h"

#include <cmath>

namespace rayfield::sim {
namespace {

// R = Rz(yaw)·Ry(pitch)·Rx(roll).
Eigen::Matrix3d rotation_from_angles(double yaw, double pitch, double roll) {
  const double cy = std::cos(yaw), sy = std::sin(yaw);
  const double cp = std::cos(pitch), sp = std::sin(pitch);
  const double cr = std::cos(roll), sr = std::sin(roll);
  Eigen::Matrix3d r;
  r << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return r;
}

}  // namespace

Eigen::Vector3d Motion::specific_force() const {
  return enu_from_imu.rotation.conjugate() * (acceleration + Eigen::Vector3d(0, 0, kGravity));
}

TrueTrajectory::PoseMatrix TrueTrajectory::pose(double t) const {
  const auto x = spline_.value(t);
  return {rotation_from_angles(x[3], x[4], x[5]), x.head<3>()};
}

Motion TrueTrajectory::motion(double t) const {
  const auto x = spline_.evaluate(t);
  const double pitch = x.value[4], roll = x.value[5];
  const double yaw_rate = x.first[3], pitch_rate = x.first[4], roll_rate = x.first[5];
  Motion motion;
  motion.enu_from_imu.rotation = Eigen::Quaterniond(rotation_from_angles(x.value[3], pitch, roll)).normalized();
  motion.enu_from_imu.translation = x.value.head<3>();
  motion.velocity = x.first.head<3>();
  motion.acceleration = x.second.head<3>();
  motion.angular_velocity = {roll_rate - yaw_rate * std::sin(pitch),
                             pitch_rate * std::cos(roll) + yaw_rate * std::cos(pitch) * std::sin(roll),
                             -pitch_rate * std::sin(roll) + yaw_rate * std::cos(pitch) * std::cos(roll)};
  return motion;
}

}  // namespace rayfield::sim
