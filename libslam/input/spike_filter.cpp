#include "libslam/input/spike_filter.h"

#include <algorithm>
#include <utility>

namespace rayfield::slam {

bool SpikeFilter::Channel::repair(const Eigen::Vector3d& before, Eigen::Vector3d& value, const Eigen::Vector3d& after) {
  constexpr double kTimesUsual = 20;
  constexpr std::uint64_t kMemory = 500;  // samples over which the usual distance is averaged
  const Eigen::Vector3d mean = 0.5 * (before + after);
  const double off = (value - mean).norm();
  if (off > std::max({floor, kTimesUsual * usual, 2 * (after - before).norm()})) {
    value = mean;
    return true;
  }
  count = std::min(count + 1, kMemory);
  usual += (off - usual) / static_cast<double>(count);
  return false;
}

std::optional<ImuSample> SpikeFilter::push(const ImuSample& sample) {
  if (held_ && before_) {
    const bool gyro =
        gyro_.repair(before_->angular_velocity_rad_s, held_->angular_velocity_rad_s, sample.angular_velocity_rad_s);
    const bool accel = accel_.repair(before_->linear_acceleration_m_s2, held_->linear_acceleration_m_s2,
                                     sample.linear_acceleration_m_s2);
    repaired_ += gyro || accel;
  }
  before_ = std::exchange(held_, sample);
  return before_;
}

std::optional<ImuSample> SpikeFilter::flush() {
  before_.reset();
  return std::exchange(held_, std::nullopt);
}

}  // namespace rayfield::slam
