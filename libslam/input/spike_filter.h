#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "rayfield/core/sensor_log.h"

namespace rayfield::slam {

/// Replaces single wrong samples (spikes) in IMU data: a gyroscope that reports 20 rad/s for a hundredth of a second
/// turns everything after it by 11°. A value is a spike where it is further from the mean of its two neighbours than
/// vehicles can shake it between two samples (0.5 rad/s, 5 m/s²), than twenty times the usual distance in these data,
/// and than twice the distance of the neighbours from each other. The mean takes its place.
class SpikeFilter {
 public:
  /// Takes a sample and gives the one before it, repaired; nothing for the first.
  std::optional<ImuSample> push(const ImuSample& sample);
  /// The last sample, which has no neighbour to compare it with.
  std::optional<ImuSample> flush();
  /// Samples of which a value was replaced.
  std::uint64_t repaired() const { return repaired_; }

 private:
  struct Channel {
    double floor, usual = 0;
    std::uint64_t count = 0;
    bool repair(const Eigen::Vector3d& before, Eigen::Vector3d& value, const Eigen::Vector3d& after);
  };
  std::optional<ImuSample> before_, held_;
  Channel gyro_{0.5}, accel_{5.0};
  std::uint64_t repaired_ = 0;
};

}  // namespace rayfield::slam
