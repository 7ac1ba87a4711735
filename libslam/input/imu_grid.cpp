#include "libslam/input/imu_grid.h"

namespace rayfield::slam {

void ImuGrid::add(const ImuSample& sample) {
  const double time = sample.time_s - epoch_s_;
  const Eigen::Vector3d& w = sample.angular_velocity_rad_s;
  const Eigen::Vector3d& a = sample.linear_acceleration_m_s2;
  // Every grid time whose cell [k − ½, k + ½]·step ends before this sample is now complete.
  while (has_last_ && (size() + 0.5) * step_s_ <= time) {
    const double at = size() * step_s_;
    if (in_cell_ > 1) {
      gyro_.push_back(gyro_sum_ / in_cell_);
      accel_.push_back(accel_sum_ / in_cell_);
    } else if (last_time_s_ <= at) {
      const double f = (at - last_time_s_) / (time - last_time_s_);
      gyro_.push_back(last_gyro_ + f * (w - last_gyro_));
      accel_.push_back(last_accel_ + f * (a - last_accel_));
    } else {
      // One sample, after the grid time: the nearest value is within half a step.
      gyro_.push_back(last_gyro_);
      accel_.push_back(last_accel_);
    }
    in_cell_ = 0;
    gyro_sum_.setZero(), accel_sum_.setZero();
  }
  if (time >= (size() - 0.5) * step_s_) {
    ++in_cell_;
    gyro_sum_ += w, accel_sum_ += a;
  }
  last_time_s_ = time, last_gyro_ = w, last_accel_ = a;
  has_last_ = true;
}

}  // namespace rayfield::slam
