#include "libslam/solver/residuals.h"

#include <algorithm>

namespace rayfield::slam {
namespace {

struct PairGeometry {
  Eigen::Vector3d between, normal;  // s_b − s_a and n
  double normals_length;            // |n_a + n_b|
};

PairGeometry pair_of(const Rigid3& pose_a, const Surfel& a, const Rigid3& pose_b, const Surfel& b) {
  const Eigen::Vector3d sum = pose_a.rotation * a.normal.cast<double>() + pose_b.rotation * b.normal.cast<double>();
  const double length = sum.norm();
  return {pose_b * b.center.cast<double>() - pose_a * a.center.cast<double>(), sum / length, length};
}

// A lidar point in the IMU frame.
struct LidarPoint {
  double time_s = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double spin_rate_rad_s = 0;
};

// Adds what one point does to e = n·(s_b − s_a) to its side, sign −1 for a and 1 for b. Its place s = t + r·c moves as
// add_place() says; besides, e changes by `tilt`·δr as its pose turns. The extra unknowns act as
//   ds/d(lidar offset) = v + ω × r·c + θ̇·r·(axis × (c − o)),   ds/d(spinner offset) = r·(axis × (c − o)).
void add_side(const ResidualFrame& frame, const LidarPoint& s, const Rigid3& pose, const Eigen::Vector3d& n,
              double sign, const Eigen::Vector3d& tilt, SplineResidual& out) {
  const Eigen::Vector3d arm = pose.rotation * s.point, place = pose.translation + arm;
  const SplineWeights w = frame.spline.weights(s.time_s);
  out.first = frame.first_knot_block + w.first;
  for (std::size_t j = 0; j < 4; ++j) {
    out.row[j] << sign * n, sign * (place - frame.anchor[w.first + j]).cross(n) + tilt;
    out.row[j] *= w.value[j];
  }
  if (frame.extra_block < 0) return;
  const Eigen::Vector3d spin = pose.rotation * frame.spin_axis.cross(s.point - frame.spin_origin);
  const Eigen::Vector3d turn = frame.track->angular_velocity(s.time_s);
  const double spinner = sign * n.dot(spin) + tilt.dot(pose.rotation * frame.spin_axis);
  out.extra = frame.extra_block;
  Vector6d& extra = out.extra_row;
  extra[kLidarOffset] +=
      sign * n.dot(frame.track->velocity(s.time_s) + turn.cross(arm)) + tilt.dot(turn) + s.spin_rate_rad_s * spinner;
  extra[kSpinnerOffset] += spinner;
}

// The normal n_s of a surfel turns by δr, which turns n and so e by δr·(n_s × p)/|n_a + n_b| with p the part of
// s_b − s_a across n.
void add_surfel_side(const ResidualFrame& frame, const Surfel& s, const Rigid3& pose, const PairGeometry& pair,
                     double sign, SplineResidual& out) {
  const Eigen::Vector3d& n = pair.normal;
  const Eigen::Vector3d across = pair.between - n * n.dot(pair.between);
  const Eigen::Vector3d tilt = (pose.rotation * s.normal.cast<double>()).cross(across) / pair.normals_length;
  const LidarPoint point{s.time_s, s.center.cast<double>(), static_cast<double>(s.spin_rate_rad_s)};
  add_side(frame, point, pose, n, sign, tilt, out);
}

void add_pole_side(const ResidualFrame& frame, const PoleObservation& v, const Rigid3& pose, double depth_m,
                   const PairGeometry& pair, double sign, SplineResidual& out) {
  const Eigen::Vector3d& n = pair.normal;
  const LidarPoint axis{v.time_s, v.center + depth_m * v.view, static_cast<double>(v.spin_rate_rad_s)};
  add_side(frame, axis, pose, n, sign, n.cross(pair.between) / pair.normals_length, out);
  if (frame.extra_block >= 0) out.extra_row[kPoleDepth] += sign * n.dot(pose.rotation * v.view);
}

// Adds factor·d(t + r·l)/dx at a time, with place = t + r·l of a point l that turns with the pose.
void add_place(const ResidualFrame& frame, double time_s, const Eigen::Vector3d& place, double factor,
               LinearResidual<3>& out) {
  const SplineWeights w = frame.spline.weights(time_s);
  for (int j = 0; j < 4; ++j) {
    auto& block = out.at(frame.first_knot_block + w.first + j);
    block.leftCols<3>().diagonal().array() += factor * w.value[j];
    block.rightCols<3>() -= factor * w.value[j] * hat(place - frame.anchor[w.first + j]);
  }
}

}  // namespace

void set_spinner(const Rig& rig, ResidualFrame& frame) {
  if (!rig.spinner) return;
  frame.spin_axis = rig.imu_from_spinner.rotation * rig.spinner->axis;
  frame.spin_origin = rig.imu_from_spinner.translation;
}

std::vector<Eigen::Vector3d> anchors_of(const CorrectionSpline& spline, const PoseTrack& track) {
  std::vector<Eigen::Vector3d> out;
  for (int j = 0; j < spline.knots(); ++j)
    out.push_back(track.pose(std::clamp(spline.start_s + (j - 1) * spline.step_s, 0.0, track.end_s())).translation);
  return out;
}

void apply_correction(const ResidualFrame& frame, const Eigen::VectorXd& knots, int first, int last, PoseTrack& track) {
  for (int k = first; k <= last; ++k) {
    const SplineWeights w = frame.spline.weights(k * track.step_s);
    const Eigen::Vector3d p = track.position[k];
    Eigen::Vector3d move = Eigen::Vector3d::Zero(), turn = move;
    for (int j = 0; j < 4; ++j) {
      const auto x = knots.segment<6>(6 * (w.first + j));
      move += w.value[j] * (x.head<3>() + x.tail<3>().cross(p - frame.anchor[w.first + j]));
      turn += w.value[j] * x.tail<3>();
    }
    track.position[k] = p + move;
    track.rotation[k] = (exp_so3(turn) * track.rotation[k]).normalized();
  }
}

double surfel_offset(const PoseTrack& track, const Surfel& a, const Surfel& b) {
  const PairGeometry pair = pair_of(track.pose(a.time_s), a, track.pose(b.time_s), b);
  return pair.between.dot(pair.normal);
}

PairResidual surfel_residual(const ResidualFrame& frame, const Surfel& a, const Surfel& b) {
  const Rigid3 pose_a = frame.track->pose(a.time_s), pose_b = frame.track->pose(b.time_s);
  const PairGeometry pair = pair_of(pose_a, a, pose_b, b);
  PairResidual out;
  out.first.error = out.second.error = pair.between.dot(pair.normal);
  out.normal = pair.normal;
  add_surfel_side(frame, a, pose_a, pair, -1, out.first);
  add_surfel_side(frame, b, pose_b, pair, 1, out.second);
  return out;
}

PairResidual pole_residual(const ResidualFrame& frame, const PoleObservation& a, const PoleObservation& b,
                           double depth_m, const Eigen::Vector3d& n) {
  const Rigid3 pose_a = frame.track->pose(a.time_s), pose_b = frame.track->pose(b.time_s);
  const auto axis = [&](const PoleObservation& v) { return Eigen::Vector3d(v.center + depth_m * v.view); };
  const PairGeometry pair{pose_b * axis(b) - pose_a * axis(a), n, 2};  // n = (n + n)/2, each held by its pose
  PairResidual out;
  out.first.error = out.second.error = n.dot(pair.between);
  out.normal = n;
  add_pole_side(frame, a, pose_a, depth_m, pair, -1, out.first);
  add_pole_side(frame, b, pose_b, depth_m, pair, 1, out.second);
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
      block.rightCols<3>() -= mean * w.value[j] * hat(force);  // d(exp(δr)·f) = δr × f = −[f]× δr
    }
  }
  const int last = first + count;
  // The mean of the second differences telescopes to a difference of two velocities.
  const Eigen::Vector3d acceleration =
      ((track.position[last] - track.position[last - 1]) - (track.position[first] - track.position[first - 1])) /
      (count * dt * dt);
  out.error = force_mean - acceleration - state.gravity;
  const double rate = 1 / (count * dt * dt);
  add_place(frame, last * dt, track.position[last], -rate, out);
  add_place(frame, (last - 1) * dt, track.position[last - 1], rate, out);
  add_place(frame, first * dt, track.position[first], rate, out);
  add_place(frame, (first - 1) * dt, track.position[first - 1], -rate, out);
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
  add_place(frame, time_s, pose.translation + arm, 1, out);
  return out;
}

}  // namespace rayfield::slam
