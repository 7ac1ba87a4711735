/// odometry: stage a: initialization and non-rigid registration in a sliding window.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "libslam/input/imu_grid.h"
#include "libslam/input/lidar_assembler.h"
#include "libslam/odometry/window.h"
#include "libslam/surfels/surfel_file.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/slam/options.h"

namespace rayfield::slam {

/// Estimated biases and gravity at a time.
struct InertialNode {
  double time_s = 0;
  InertialState state;
};

/// How the drive began.
struct InitialMotion {
  double stationary_s = 0;                             ///< time at rest, 0 if the drive began in motion
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< initial, in the levelled frame of the first pose, m/s
};

/// Result of stage a, which the global registration refines. Times are seconds after the epoch.
struct OdometryResult {
  double epoch_s = 0;
  PoseTrack track;
  SurfelFile surfels;
  std::vector<Surfel> poles;  ///< detections in the order of time bins: some ten a second
  std::vector<InertialNode> inertial;
  std::vector<WindowStats> windows;
  InitialMotion initial_motion;
  InertialNoise noise;
  BeamSource source;  ///< its origin is that of the newest beam
};

/// Stage a, streaming: keeps the points of the bins that are not yet complete and the surfels of the whole drive.
class Odometry {
 public:
  Odometry(const Rig& rig, const SlamOptions& options, double epoch_s);

  void add(const ImuSample& sample) { imu_.add(sample); }
  void add(const BodyScan& scan);

  /// A fix (seconds after the epoch, any tangent plane), used to find the initial motion of a drive that does not
  /// begin at rest.
  void add_fix(double time_s, const Eigen::Vector3d& enu);

  /// Solves every window whose data are complete; with `flush` all that is left.
  Result<void> advance(bool flush);

  /// Ends the stage. Errors: bad_input if the drive is too short to be solved.
  Result<OdometryResult> finish();

  const ImuGrid& imu() const { return imu_; }

 private:
  Result<void> initialize();
  Result<void> initialize_in_motion(int last_sample);
  Result<void> step(double window_end_s);
  Result<void> last_step();
  void integrate_to(int last_sample);
  Result<void> extract_to(double time_s);
  Result<void> solve(int first_sample, int last_sample, bool first);

  Rig rig_;
  SlamOptions options_;
  ImuGrid imu_;
  bool initialized_ = false;
  double done_s_ = 0;        // the trajectory is solved up to here
  double lidar_end_s_ = -1;  // time of the newest point
  std::int64_t extracted_bins_ = 0;
  std::vector<std::vector<BodyPoint>> pending_;  // points by bin, from bin extracted_bins_ on
  // The surfels of the newest bins, as many as a window may need.
  struct Bin {
    std::int64_t index = 0;
    std::size_t count = 0;
  };
  std::vector<Surfel> newest_;
  std::deque<Bin> newest_bins_;
  std::vector<std::pair<double, Eigen::Vector3d>> first_fixes_;  // until initialized
  InertialState state_;
  Matrix8d inertial_covariance_ = Matrix8d::Identity();
  OdometryResult out_;
};

}  // namespace rayfield::slam
