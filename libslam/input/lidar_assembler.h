/// input: from a log's messages to clean data: IMU samples on a grid without spikes, lidar points in the IMU frame.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"

namespace rayfield::slam {

/// Rays of one lidar message in the IMU frame, each at its own time.
struct BodyScan {
  std::vector<double> time_s;              ///< on the IMU clock, absolute
  std::vector<Eigen::Vector3d> origin;     ///< of the beam in the IMU frame, m
  std::vector<Eigen::Vector3d> direction;  ///< unit, IMU frame
  std::vector<float> range_m;              ///< as in LidarScan, after the rig's limits: finite = hit, +inf = none
  std::vector<float> intensity;
  std::vector<float> spin_rate_rad_s;

  void clear() {
    time_s.clear(), origin.clear(), direction.clear(), range_m.clear(), intensity.clear(), spin_rate_rad_s.clear();
  }
};

/// What came in and what was left out.
struct AssemblerCounts {
  std::uint64_t scans = 0, points = 0, hits = 0;
  std::uint64_t invalid_points = 0;  ///< NaN, too close, or a direction that is not a unit vector
  std::uint64_t scans_without_angle = 0;
  std::uint64_t late_scans = 0;      ///< stamped before data that was already used
  std::uint64_t unusable_scans = 0;  ///< unequal columns or a time that is not finite
  double spinner_turn_rad = 0;       ///< total absolute rotation of the spinner
};

/// Brings lidar points into the IMU frame: p_imu = imu_from_spinner · Rot(axis, θ(t)) · spinner_from_lidar · p, with
/// the encoder angle interpolated at each point's own time and unwrapped. Scans wait until the encoder data cover them.
class LidarAssembler {
 public:
  /// `angle_offset_rad` is added to the encoder angle.
  LidarAssembler(const Rig& rig, double lidar_offset_s, double angle_offset_rad);

  void add(const SpinnerAngle& angle);
  void add(const LidarScan& scan);

  /// Hands over every scan that is complete, in order; with `flush` also ends the wait for the encoder.
  void drain(const std::function<void(const BodyScan&)>& take, bool flush = false);

  const AssemblerCounts& counts() const { return counts_; }

 private:
  struct AngleSample {
    double time_s, angle_rad;
  };
  void assemble(const LidarScan& scan, BodyScan& out);
  bool angle_at(double time_s, double& angle, double& rate);

  Rig rig_;
  double lidar_offset_s_, angle_offset_rad_;
  std::deque<AngleSample> angles_;  // unwrapped
  std::size_t cursor_ = 0;          // index into angles_ at or below the last query
  std::deque<LidarScan> waiting_;
  double last_scan_s_ = -1e300;
  AssemblerCounts counts_;
  BodyScan scratch_;
};

}  // namespace rayfield::slam
