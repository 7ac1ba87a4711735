#pragma once

#include <Eigen/Core>
#include <span>

#include "libslam/input/imu_grid.h"
#include "libslam/solver/residuals.h"
#include "libslam/surfels/surfel.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/slam/options.h"

namespace rayfield::slam {

/// Standard deviations of IMU residuals; `scale` ≥ 1 grows where the data are noisier than the rig file says.
struct InertialNoise {
  double gyro_density = 3e-4, accel_density = 3e-3;  ///< rad/s/√Hz, m/s²/√Hz
  double gyro_scale = 1, accel_scale = 1;
  /// Variance of a residual that is the mean over `duration_s`.
  double gyro_variance(double duration_s) const;
  double accel_variance(double duration_s) const;
};

/// Covariance of gyro bias, accelerometer bias and the two horizontal components of gravity, which pass from one window
/// to the next. They have to be treated together: at rest only gravity less accelerometer bias is seen.
using Matrix8d = Eigen::Matrix<double, 8, 8>;

/// What is known before a window is solved.
struct WindowPrior {
  bool first =
      false;  ///< the pose at the window's start is the gauge; otherwise the trajectory joins what is fixed before it
  Matrix8d covariance = Matrix8d::Identity();  ///< of biases and gravity
};

/// Result of a window, apart from the track.
struct WindowStats {
  double start_s = 0, end_s = 0;
  int matches = 0;
  double inlier_fraction = 0;  ///< matches within three standard deviations
  double surfel_rms_m = 0;     ///< weighted by the final robust weights
  /// Standard deviation of the window's mean translation from lidar alone along its weakest direction, m.
  double weakest_sigma_m = 0;
  Eigen::Vector3d weakest_direction = Eigen::Vector3d::Zero();
  Matrix8d covariance = Matrix8d::Zero();  ///< of biases and gravity, after the window
};

/// Optimises track[first_sample … last_sample] in place, and the biases and gravity in `state`; matches and weights are
/// found anew at every iteration (docs/slam.md, "Stage a: windows"). Errors: bad_input where the system is singular.
Result<WindowStats> solve_window(PoseTrack& track, const ImuGrid& imu, std::span<const Surfel> surfels,
                                 const SlamOptions& options, const InertialNoise& noise, const WindowPrior& prior,
                                 int first_sample, int last_sample, InertialState& state);

}  // namespace rayfield::slam
