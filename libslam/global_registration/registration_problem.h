#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "libslam/global_registration/global_registration.h"
#include "libslam/odometry/window.h"
#include "libslam/solver/residuals.h"
#include "libslam/solver/surfel_terms.h"
#include "libslam/surfels/surfel_match.h"
#include "libslam/surfels/surfel_regions.h"

namespace rayfield::slam {

/// How the data of an iteration are weighted.
struct RegistrationWeights {
  double slack_m = 0;     ///< of loop closures, see SurfelWeights
  double gps_slack = 0;   ///< factor on the scale of the robust weights of fixes; 0 leaves GPS out
  bool cautious = false;  ///< surfels are weighted for uncertainties rather than for the solution
};

/// What is estimated apart from trajectory and biases.
struct RegistrationUnknowns {
  Eigen::Vector2d offsets = Eigen::Vector2d::Zero();  ///< lidar (s), spinner (rad)
  double pole_depth_m = 0;                            ///< from the visible surface of poles to their axes
};

/// The normal equations of the global registration. Blocks: knots of the correction spline, bias nodes, one extra
/// block.
class RegistrationProblem {
 public:
  /// `knot_step_s`: spacing of the correction spline. `unknowns`: as estimated so far.
  RegistrationProblem(OdometryResult& odometry, const ImuGrid& imu, std::span<const GpsPosition> fixes, const Rig& rig,
                      const SlamOptions& options, double knot_step_s, const RegistrationUnknowns& unknowns);

  /// Builds the system at the present trajectory: begin(), the surfels of all regions, the poles, end(), which fills
  /// the residual statistics. What is added depends on the order of the regions, not on the number of threads.
  void begin(const RegistrationWeights& weights);
  void add_surfels(std::span<const Surfel> surfels, std::span<const SurfelMatch> near,
                   std::span<const SurfelMatch> revisits);
  void add_poles(const PoleQuery& query);
  void end(RegistrationStats& stats);

  /// Solves the system and moves trajectory, biases and offsets. Returns the largest move of a knot, less yaw and
  /// translation of the whole, m.
  Result<double> solve_and_apply();

  const RegistrationUnknowns& unknowns() const { return unknowns_; }
  /// The offsets in the form in which they are applied to surfels.
  SurfelOffsets surfel_offsets() const;
  double knot_step_s() const { return knot_step_s_; }

  /// Where the trajectory contradicts the IMU most, which is how lanes that were taken for one another show.
  void measure_imu_misfit(RegistrationStats& stats) const;

  /// Marginal covariances with the pose in the middle of the drive held, and those of the estimated offsets.
  Result<void> measure_uncertainty(RegistrationStats& stats);

 private:
  BiasWeights bias_weights(double time_s) const;
  InertialState inertial_at(const BiasWeights& w) const;
  void add_inertial(int first_group, int last_group, BlockSystem& system, Eigen::Vector2d& squares) const;
  void add_gps(double slack, BlockSystem& system, RegistrationStats& stats) const;
  /// Weak ones on every knot, so that what nothing else holds stays where it is; biases walk as the rig says, offsets
  /// that are estimated begin at those of the rig.
  void add_priors(bool use_gps, BlockSystem& system) const;

  OdometryResult& odometry_;
  const ImuGrid& imu_;
  std::span<const GpsPosition> fixes_;
  const Rig& rig_;
  const SlamOptions& options_;
  ResidualFrame frame_, surfel_frame_;
  double knot_step_s_;
  int bias_nodes_, first_bias_block_;
  std::vector<Eigen::Vector3d> gyro_bias_, accel_bias_;  // at the nodes
  Eigen::Vector3d gravity_;
  RegistrationUnknowns unknowns_;
  // The normal equations: `chain` along time, with both diagonal parts of loop closures, and `coupling` between their
  // two sides.
  struct Sums {
    BlockSystem chain, coupling;
    SurfelSums near, revisits, poles;
    Eigen::Vector2d squares = Eigen::Vector2d::Zero();  // of the residuals of gyroscope and accelerometer
  };
  Sums sums_;
  RegistrationWeights weights_;
  std::vector<Sums> parts_;  // partial sums, kept for their sparsity pattern
};

}  // namespace rayfield::slam
