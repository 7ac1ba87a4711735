#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>

#include "libslam/input/imu_grid.h"
#include "libslam/solver/residuals.h"
#include "libslam/surfels/surfel_match.h"
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

/// Gyro bias, accelerometer bias, and the two horizontal components of gravity: what one window hands to the next.
/// They belong together: at rest only gravity less accelerometer bias is seen.
using Matrix8d = Eigen::Matrix<double, 8, 8>;

/// What is known before a window is solved.
struct WindowPrior {
  bool first = false;  ///< the pose at the window's start is the gauge; otherwise the trajectory joins a frozen past
  Matrix8d covariance = Matrix8d::Identity();  ///< of biases and gravity
};

/// How a window went.
struct WindowStats {
  double start_s = 0, end_s = 0;
  int iterations = 0;
  int surfels = 0, matches = 0;
  double inlier_fraction = 0;          ///< matches within three standard deviations
  double surfel_rms_m = 0;             ///< weighted by the final robust weights
  double gyro_rms = 0, accel_rms = 0;  ///< in standard deviations of the rig's noise
  /// Standard deviation of the window's mean translation from lidar alone along its weakest direction, m.
  double weakest_sigma_m = 0;
  Eigen::Vector3d weakest_direction = Eigen::Vector3d::Zero();
  Matrix8d covariance = Matrix8d::Zero();  ///< of biases and gravity, after the window
};

/// What the surfel residuals of one iteration say together.
struct SurfelSums {
  std::size_t matches = 0, inliers = 0;                   ///< inliers: within three standard deviations
  double weights = 0, squares = 0;                        ///< of the robust weights, of weighted squared offsets (m²)
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< on a shift of one side, independent matches, 1/m²
  double rms_m() const { return weights > 0 ? std::sqrt(squares / weights) : 0; }
  void add(const SurfelSums& other);
};

/// How surfel residuals are weighted.
struct SurfelWeights {
  double sigma_m = 0.005;  ///< standard deviation of an offset apart from the surfels' own thickness
  double cauchy = 1;       ///< Cauchy scale in standard deviations
  /// By how much offsets may be off besides: the weight is 1/(variance + slack²), and Cauchy's scale is
  /// √(cauchy²·variance + slack²). So whole lanes move that are further apart than their surfels are thick, and wrong
  /// matches do not outvote the IMU meanwhile.
  double slack_m = 0;
  /// Part of the variance of the surfels' layers that counts: their centres are known better than that.
  double layer_share = 1;
  /// Factor on all weights: how many independent ones a match counts for.
  double share = 1;
};
/// Surfels of overlapping voxels and resolutions share points, so that uncertainties count a match as a fifth. The
/// solution counts it whole: errors are smaller so, as measured (docs/slam.md).
inline constexpr double kIndependentShare = 0.2;

/// Adds the robustly weighted surfel residuals of `matches` to `system`.
/// What ties the two surfels of a match goes to `coupling`, which may be `system` itself.
SurfelSums add_surfel_terms(const ResidualFrame& frame, std::span<const Surfel> surfels,
                            std::span<const SurfelMatch> matches, const SurfelWeights& weights, BlockSystem& system,
                            BlockSystem& coupling);

/// Optimises track[first_sample … last_sample] in place, and the biases and gravity in `state`.
/// method: 2a; re-associates and re-weights at every iteration. Errors: bad_input where the system is singular.
Result<WindowStats> solve_window(PoseTrack& track, const ImuGrid& imu, std::span<const Surfel> surfels,
                                 const SlamOptions& options, const InertialNoise& noise, const WindowPrior& prior,
                                 int first_sample, int last_sample, InertialState& state);

/// Moves track[first … last] by the knots' corrections (six values each from `knots`), as residuals.h says.
void apply_correction(const ResidualFrame& frame, const Eigen::VectorXd& knots, int first, int last, PoseTrack& track);

/// The point of a spinner's axis and its direction in the IMU frame; zero without a spinner.
void set_spinner(const Rig& rig, ResidualFrame& frame);

}  // namespace rayfield::slam
