#include "residuals.h"

namespace rayfield::slam {
namespace {

enum Extra { kGravityX = 0, kGravityY = 1, kLidarOffset = 2, kSpinnerOffset = 3 };

// Adds sign·d(n·s)/dx for a surfel at world arm = r·c: d(n·s) = n·δt + (arm × n)·δr, and for the extra unknowns
//   ds/d(lidar offset) = v + ω × arm + θ̇·r·(axis × (c − o)),   ds/d(spinner offset) = r·(axis × (c − o)).
void add_surfel_side(const ResidualFrame& frame, const Surfel& s, const Rigid3& pose, const Eigen::Vector3d& n,
                     double sign, LinearResidual<1>& out) {
  const Eigen::Vector3d arm = pose.rotation * s.center.cast<double>();
  Vector6d d;
  d << n, arm.cross(n);
  const SplineWeights w = frame.spline.weights(s.time_s);
  for (int j = 0; j < 4; ++j) out.at(frame.first_knot_block + w.first + j) += sign * w.value[j] * d.transpose();
  if (frame.extra_block < 0) return;
  const Eigen::Vector3d spin = pose.rotation * frame.spin_axis.cross(s.center.cast<double>() - frame.spin_origin);
  const Eigen::Vector3d motion = frame.track->velocity(s.time_s) + frame.track->angular_velocity(s.time_s).cross(arm);
  auto& extra = out.at(frame.extra_block);
  extra[kLidarOffset] += sign * n.dot(motion + static_cast<double>(s.spin_rate_rad_s) * spin);
  extra[kSpinnerOffset] += sign * n.dot(spin);
}

}  // namespace

LinearResidual<1> surfel_residual(const ResidualFrame& frame, const Surfel& a, const Surfel& b) {
  LinearResidual<1> out;
  const Rigid3 pose_a = frame.track->pose(a.time_s), pose_b = frame.track->pose(b.time_s);
  const Eigen::Vector3d sa = pose_a * a.center.cast<double>(), sb = pose_b * b.center.cast<double>();
  const Eigen::Vector3d n =
      (pose_a.rotation * a.normal.cast<double>() + pose_b.rotation * b.normal.cast<double>()).normalized();
  out.error[0] = (sb - sa).dot(n);
  add_surfel_side(frame, a, pose_a, n, -1, out);
  add_surfel_side(frame, b, pose_b, n, 1, out);
  return out;
}

LinearResidual<3> accel_residual(const ResidualFrame& frame, const BiasWeights& bias, const InertialState& state,
                                 const std::vector<Eigen::Vector3d>& accel, int first, int count) {
  const PoseTrack& track = *frame.track;
  const double dt = track.step_s, mean = 1.0 / count;
  LinearResidual<3> out;
  Eigen::Matrix3d rotation_mean = Eigen::Matrix3d::Zero();
  Eigen::Vector3d force_mean = Eigen::Vector3d::Zero();
  for (int k = first; k < first + count; ++k) {
    const Eigen::Matrix3d r = track.rotation[k].toRotationMatrix();
    const Eigen::Vector3d force = r * (accel[k] - state.accel_bias);
    rotation_mean += mean * r;
    force_mean += mean * force;
    const SplineWeights w = frame.spline.weights(k * dt);
    for (int j = 0; j < 4; ++j) {
      auto& block = out.at(frame.first_knot_block + w.first + j);
      // d(exp(δr)·f) = δr × f = −[f]× δr;  d(−ẗ) = −δẗ.
      block.leftCols<3>().diagonal().array() -= mean * w.second_derivative[j];
      block.rightCols<3>() -= mean * w.value[j] * hat(force);
    }
  }
  const int last = first + count;
  // The mean of the second differences telescopes to a difference of two velocities.
  const Eigen::Vector3d acceleration =
      ((track.position[last] - track.position[last - 1]) - (track.position[first] - track.position[first - 1])) /
      (count * dt * dt);
  out.error = force_mean - acceleration - state.gravity;
  for (int j = 0; j < 2; ++j)
    if (bias.weights[j] != 0) out.at(bias.blocks[j]).rightCols<3>() -= bias.weights[j] * rotation_mean;
  if (frame.extra_block >= 0) {
    auto& extra = out.at(frame.extra_block);
    // Gravity keeps its length: dz = −(x dx + y dy)/z.
    extra.col(kGravityX) -= Eigen::Vector3d(1, 0, -state.gravity.x() / state.gravity.z());
    extra.col(kGravityY) -= Eigen::Vector3d(0, 1, -state.gravity.y() / state.gravity.z());
  }
  return out;
}

LinearResidual<3> gyro_residual(const ResidualFrame& frame, const BiasWeights& bias, const InertialState& state,
                                const std::vector<Eigen::Vector3d>& gyro, int first, int count) {
  const PoseTrack& track = *frame.track;
  const double dt = track.step_s, duration = count * dt;
  Eigen::Quaterniond measured = Eigen::Quaterniond::Identity();
  for (int k = first; k < first + count; ++k) measured = measured * exp_so3(0.5 * dt * (gyro[k] + gyro[k + 1]));
  const Eigen::Quaterniond &r0 = track.rotation[first], &r1 = track.rotation[first + count];
  const Eigen::Vector3d phi = log_so3(measured.conjugate() * (r0.conjugate() * r1));
  LinearResidual<3> out;
  out.error = phi / duration + state.gyro_bias;
  // r0⁻¹·exp(−δ0)·exp(δ1)·r1 = r0⁻¹·r1·exp(r1⁻¹(δ1 − δ0)) to first order, so dφ = Jr⁻¹(φ)·r1⁻¹·(δ1 − δ0).
  const Eigen::Matrix3d d = right_jacobian_inverse(phi) * r1.conjugate().toRotationMatrix() / duration;
  const SplineWeights w0 = frame.spline.weights(first * dt), w1 = frame.spline.weights((first + count) * dt);
  for (int j = 0; j < 4; ++j) out.at(frame.first_knot_block + w0.first + j).rightCols<3>() -= w0.value[j] * d;
  for (int j = 0; j < 4; ++j) out.at(frame.first_knot_block + w1.first + j).rightCols<3>() += w1.value[j] * d;
  for (int j = 0; j < 2; ++j)
    if (bias.weights[j] != 0) out.at(bias.blocks[j]).leftCols<3>().diagonal().array() += bias.weights[j];
  return out;
}

LinearResidual<3> gps_residual(const ResidualFrame& frame, double time_s, const Eigen::Vector3d& lever_arm_m,
                               const Eigen::Vector3d& position) {
  const Rigid3 pose = frame.track->pose(time_s);
  const Eigen::Vector3d arm = pose.rotation * lever_arm_m;
  LinearResidual<3> out;
  out.error = pose.translation + arm - position;
  const SplineWeights w = frame.spline.weights(time_s);
  for (int j = 0; j < 4; ++j) {
    auto& block = out.at(frame.first_knot_block + w.first + j);
    block.leftCols<3>().diagonal().array() += w.value[j];
    block.rightCols<3>() -= w.value[j] * hat(arm);
  }
  return out;
}

}  // namespace rayfield::slam
