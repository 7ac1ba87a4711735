#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/formats/rosbag_writer.h"

namespace rayfield::formats {

/// The beams of a 2D lidar: beam i points to (cos a, sin a, 0) in the lidar frame with
/// a = angle_min_rad + i·angle_increment_rad, and is measured at the stamp + i·time_increment_s.
struct ScanPattern {
  std::size_t beams = 0;
  double angle_min_rad = 0;
  double angle_increment_rad = 0;
  double time_increment_s = 0;
  double scan_time_s = 0;  ///< between two scans
  double range_min_m = 0, range_max_m = 0;
};

/// Writes the sensors of a rig as a ROS 1 bag: sensor_msgs/LaserScan, MultiEchoLaserScan or PointCloud2, Imu,
/// NavSatFix, JointState on the topics of the rig, each message recorded at its stamp. Ranges are given after REP 117
/// (+inf nothing, -inf too close, NaN invalid) and written after the rig's `no_return`. Equal calls give equal bytes.
class SensorLogWriter {
 public:
  static Result<SensorLogWriter> create(const std::string& path, const Rig& rig, const BagWriteOptions& options = {});
  SensorLogWriter(SensorLogWriter&&) noexcept;
  SensorLogWriter& operator=(SensorLogWriter&&) noexcept;
  ~SensorLogWriter();

  Result<void> imu(const ImuSample& sample);
  /// Errors: usage where the rig has no gps.
  Result<void> gps(const GpsFix& fix);
  /// `rate_rad_s` goes into the message's velocity. Errors: usage where the rig has no spinner.
  Result<void> spinner(const SpinnerAngle& angle, double rate_rad_s);
  /// A LaserScan with `range_m.size()` = pattern.beams; `intensity` of that size or empty. Errors: usage (sizes).
  Result<void> scan(double time_s, const ScanPattern& pattern, std::span<const float> range_m,
                    std::span<const float> intensity);
  /// A MultiEchoLaserScan: of a beam without a return no echo, else the one of the scan and those of LidarScan::later.
  /// The scan's directions and times are those of the pattern. Errors: usage (sizes; later echoes that are out of
  /// order or follow no return).
  Result<void> multi_echo_scan(const ScanPattern& pattern, const LidarScan& scan);
  /// A PointCloud2 with the fields x y z intensity (float32), ring (uint16), time (float32, s after the stamp).
  /// A point cloud keeps the direction of a ray without a return only under no_return = max_range; otherwise such
  /// points are written as most drivers do: NaN (infinity) or zeros (zero), and readers need the rings to find the
  /// direction again. `ring` of the scan's size or empty. LidarScan::later are points of their beams' rings and times,
  /// behind all others. Errors: usage (sizes; later echoes as above).
  Result<void> points(const LidarScan& scan, std::span<const std::uint16_t> ring);
  /// Completes the file. Nothing can be written afterwards.
  Result<void> close();

 private:
  struct Impl;
  explicit SensorLogWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfield::formats
