#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "global.h"
#include "rayfield/core/parallel.h"
#include "residuals.h"
#include "surfel_match.h"

namespace rayfield::slam {

/// The normal equations of the global stage. Blocks: knots of the correction spline, bias nodes, one extra block.
class GlobalProblem {
 public:
  GlobalProblem(OdometryResult& odometry, const ImuGrid& imu, std::span<const GpsPosition> fixes, const Rig& rig,
                const SlamOptions& options);

  /// Builds the system at the present trajectory and fills the residual statistics.
  Result<void> linearise(std::span<const SurfelMatch> near, std::span<const SurfelMatch> revisits, double cauchy,
                         bool use_gps, GlobalStats& stats);

  /// Solves the system and moves trajectory, biases and offsets.
  Result<void> solve_and_apply();

  /// Marginal covariances with the pose in the middle of the drive held, and those of the estimated offsets.
  Result<void> measure_uncertainty(GlobalStats& stats);

 private:
  BiasWeights bias_weights(double time_s) const;
  InertialState inertial_at(const BiasWeights& w) const;
  void add_inertial(int first_group, int last_group, BlockSystem& system, Eigen::Vector2d& squares) const;
  void add_gps(BlockSystem& system, GlobalStats& stats) const;
  void add_priors(bool use_gps, BlockSystem& system) const;
  void rotate_surfels(double lidar_offset_s, double spinner_offset_rad);

  OdometryResult& odometry_;
  const ImuGrid& imu_;
  std::span<const GpsPosition> fixes_;
  const Rig& rig_;
  const SlamOptions& options_;
  ResidualFrame frame_, surfel_frame_;
  int bias_nodes_, first_bias_block_;
  std::vector<Eigen::Vector3d> gyro_bias_, accel_bias_;  // at the nodes
  Eigen::Vector3d gravity_;
  Eigen::Vector2d offsets_ = Eigen::Vector2d::Zero();  // estimated: lidar (s), spinner (rad)
  BlockSystem system_;
  std::vector<BlockSystem> parts_;  // partial sums, kept for their sparsity pattern
};

}  // namespace rayfield::slam
