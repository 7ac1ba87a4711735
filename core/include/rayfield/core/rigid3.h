#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rayfield {

/// A rigid transform named `target_from_source`: p_in_target = rotation * p_in_source + translation.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& p_in_source) const { return rotation * p_in_source + translation; }
  /// c_from_a = c_from_b * b_from_a
  Rigid3 operator*(const Rigid3& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
  }
  Rigid3 inverse() const {
    const Eigen::Quaterniond inv = rotation.conjugate();
    return {inv, -(inv * translation)};
  }
};

/// A pose at a time: frame of the body relative to the map.
struct TimedPose {
  double time_s = 0;  ///< Unix time, s
  Rigid3 map_from_body;
};

}  // namespace rayfield
