#pragma once

#include <Eigen/Core>
#include <vector>

#include "rayfield/core/sensor_log.h"

namespace rayfield::slam {

/// IMU samples on the uniform time grid of PoseTrack: sample k at k·step_s after the epoch. Sensors at about the grid's
/// rate or slower are interpolated linearly, faster ones averaged over the grid cell.
class ImuGrid {
 public:
  ImuGrid(double epoch_s, double step_s) : epoch_s_(epoch_s), step_s_(step_s) {}

  /// Takes the next sample; its time must be later than that of the sample before.
  void add(const ImuSample& sample);

  int size() const { return static_cast<int>(gyro_.size()); }
  double end_s() const { return (size() - 1) * step_s_; }
  double epoch_s() const { return epoch_s_; }
  double step_s() const { return step_s_; }
  const std::vector<Eigen::Vector3d>& gyro() const { return gyro_; }    ///< rad/s, raw (biases included)
  const std::vector<Eigen::Vector3d>& accel() const { return accel_; }  ///< m/s², raw

 private:
  double epoch_s_, step_s_;
  bool has_last_ = false;
  double last_time_s_ = 0;
  Eigen::Vector3d last_gyro_, last_accel_;
  // Running mean over the grid cell of sample size(), used where several samples fall into it.
  int in_cell_ = 0;
  Eigen::Vector3d gyro_sum_ = Eigen::Vector3d::Zero(), accel_sum_ = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> gyro_, accel_;
};

}  // namespace rayfield::slam
