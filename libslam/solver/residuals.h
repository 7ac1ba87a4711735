#pragma once

#include <Eigen/Core>
#include <vector>

#include "libslam/solver/block_system.h"
#include "libslam/surfels/pole_observations.h"
#include "libslam/surfels/surfel.h"
#include "libslam/trajectory/correction_spline.h"
#include "libslam/trajectory/pose_track.h"
#include "rayfield/core/rig.h"

/// Residuals of both stages, linearised at zero correction: after every iteration the correction is applied to the
/// trajectory, so the derivatives are needed there only. Knot j with weight w_j(τ) moves its anchor c_j by δt_j and
/// turns the trajectory about it by δr_j:
///   t(τ) ← t(τ) + Σ w_j·(δt_j + δr_j × (t(τ) − c_j)),  r(τ) ← exp(Σ w_j·δr_j)·r(τ).
/// The paper (SLAM) has t ← t + δt(τ) for the first. Turning about anchors keeps the shape of a part of the
/// drive that is turned as a whole, at any knot spacing: a yaw drift over many lanes is corrected without bending the
/// turns between them. A knot's block is (δt, δr); a bias block is (gyro, accelerometer) in rad/s and m/s²; the extra
/// block is what ExtraUnknown says.
namespace rayfield::slam {

/// Places in the extra block; the sixth is unused. Gravity (world, m/s²), lidar clock (s), spinner angle (rad), depth
/// of poles (m).
enum ExtraUnknown { kGravityX = 0, kGravityY = 1, kLidarOffset = 2, kSpinnerOffset = 3, kPoleDepth = 4 };

/// What the linearisation of a residual refers to.
struct ResidualFrame {
  const PoseTrack* track = nullptr;
  CorrectionSpline spline;
  std::vector<Eigen::Vector3d> anchor;  ///< of each knot, see anchors_of()
  int first_knot_block = 0;             ///< block of knot 0
  int extra_block = -1;
  Eigen::Vector3d spin_axis = Eigen::Vector3d::Zero();    ///< in the IMU frame; zero for a fixed lidar
  Eigen::Vector3d spin_origin = Eigen::Vector3d::Zero();  ///< a point of the spinner's axis in the IMU frame, m
};

/// Sets the spinner's axis in the IMU frame; without a spinner it stays zero.
void set_spinner(const Rig& rig, ResidualFrame& frame);

/// The positions of the track at the knots of a spline.
std::vector<Eigen::Vector3d> anchors_of(const CorrectionSpline& spline, const PoseTrack& track);

/// Moves track[first … last] by the corrections of the knots, six values each, as above.
void apply_correction(const ResidualFrame& frame, const Eigen::VectorXd& knots, int first, int last, PoseTrack& track);

/// Biases at one time as a weighted sum of bias blocks (linear between nodes).
struct BiasWeights {
  int blocks[2] = {0, 0};
  double weights[2] = {1, 0};
};

/// Sensor biases and gravity at the linearisation point.
struct InertialState {
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();       ///< rad/s
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();      ///< m/s²
  Eigen::Vector3d gravity = Eigen::Vector3d(0, 0, 9.80665);  ///< world, the specific force at rest (up), m/s²
};

/// e = (s_b − s_a)·n,  n = (n_a + n_b)/|n_a + n_b|  (paper, SLAM: e_surf), m. n turns with the correction: turning both
/// surfels alike leaves e as it is, so that nothing but GPS turns the map.
/// The Jacobian is first + second: what each surfel's pose does to e. Both hold e.
struct PairResidual {
  SplineResidual first, second;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< n
  double error() const { return first.error; }
};
/// e alone, m.
double surfel_offset(const PoseTrack& track, const Surfel& a, const Surfel& b);
PairResidual surfel_residual(const ResidualFrame& frame, const Surfel& a, const Surfel& b);

/// e = (q_b − q_a)·n with the axes q = t(τ) + r(τ)·(c + depth·v) of two observations of a pole, m. n turns with the
/// correction, as that of surfels.
PairResidual pole_residual(const ResidualFrame& frame, const PoleObservation& a, const PoleObservation& b,
                           double depth_m, const Eigen::Vector3d& n);

/// Mean over the samples first … first+count-1 of
///   e = r(τ)·(a − b_a) − ẗ(τ) − g     (paper, SLAM: e_imu,a; g points up: the specific force at rest), m/s²,
/// ẗ by second differences of the grid. first ≥ 1 and first+count < track size.
LinearResidual<3> accel_residual(const ResidualFrame& frame, const BiasWeights& bias, const InertialState& state,
                                 const std::vector<Eigen::Vector3d>& accel, int first, int count);

/// Mean angular velocity over the interval from sample first to first+count:
///   e = log(ΔR⁻¹ · r(τ₀)⁻¹ · r(τ₁))/(τ₁ − τ₀) + b_g    (paper, SLAM: e_imu,r as a finite difference), rad/s,
/// ΔR the product of exp(½(ω_k + ω_{k+1})·dt) over the interval, raw rates.
LinearResidual<3> gyro_residual(const ResidualFrame& frame, const BiasWeights& bias, const InertialState& state,
                                const std::vector<Eigen::Vector3d>& gyro, int first, int count);

/// e = t(τ) + r(τ)·l − p_gps   (paper, GPS, with the lever arm l and H already applied to the trajectory), m.
LinearResidual<3> gps_residual(const ResidualFrame& frame, double time_s, const Eigen::Vector3d& lever_arm_m,
                               const Eigen::Vector3d& position);

}  // namespace rayfield::slam
