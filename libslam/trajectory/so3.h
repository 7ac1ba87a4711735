#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

/// Rotation vectors and quaternions. Rotation vectors are in rad; all maps are exact to rounding near zero.
namespace rayfield::slam {

/// hat(a)·b = a × b.
inline Eigen::Matrix3d hat(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

/// The rotation by |phi| about phi.
inline Eigen::Quaterniond exp_so3(const Eigen::Vector3d& phi) {
  const double angle2 = phi.squaredNorm();
  double real, factor;
  if (angle2 < 1e-8) {  // series: the next terms are below 1e-17
    real = 1 - angle2 / 8;
    factor = 0.5 - angle2 / 48;
  } else {
    const double angle = std::sqrt(angle2);
    real = std::cos(angle / 2);
    factor = std::sin(angle / 2) / angle;
  }
  return {real, factor * phi.x(), factor * phi.y(), factor * phi.z()};
}

/// The rotation vector of a unit quaternion, |phi| ≤ π.
inline Eigen::Vector3d log_so3(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1 : 1;
  const double sine = q.vec().norm();
  if (sine < 1e-9) return 2 * sign * q.vec();
  return sign * 2 * std::atan2(sine, sign * q.w()) / sine * q.vec();
}

/// From `a` (f = 0) to `b` (f = 1) along the geodesic. Where they are closer than 1.6° the chord is as good: it errs by
/// angle³/64 at most, 4e-7 rad.
inline Eigen::Quaterniond between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, double f) {
  const double cosine = a.dot(b);
  if (std::abs(cosine) < 0.9999) return a.slerp(f, b);
  Eigen::Quaterniond q;
  q.coeffs() = (1 - f) * a.coeffs() + (cosine < 0 ? -f : f) * b.coeffs();
  return q.normalized();
}

/// Inverse right Jacobian of SO(3): log(exp(phi)·exp(x)) = phi + right_jacobian_inverse(phi)·x + O(x²).
/// Solà, Deray, Atchuthan: A micro Lie theory for state estimation in robotics, eq. 144.
inline Eigen::Matrix3d right_jacobian_inverse(const Eigen::Vector3d& phi) {
  const double angle2 = phi.squaredNorm();
  const Eigen::Matrix3d k = hat(phi);
  double factor = 1.0 / 12;
  if (angle2 > 1e-6) {
    const double angle = std::sqrt(angle2);
    factor = 1 / angle2 - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
  }
  return Eigen::Matrix3d::Identity() + 0.5 * k + factor * k * k;
}

}  // namespace rayfield::slam
