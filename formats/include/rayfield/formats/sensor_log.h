#pragma once

#include <string>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/formats/rosbag_reader.h"
#include "rayfield/formats/sensor_log_report.h"

/// Reading the sensors of a rig from a log (docs/rosbag.md): sensor_msgs LaserScan or PointCloud2, Imu, NavSatFix,
/// JointState from ROS 1 bags.
namespace rayfield::formats {

struct LogOptions {
  BagReadOptions bag;
  /// Messages of a topic are brought into the order of their stamps when they come up to this late; later ones are
  /// left out. Memory holds this much of the log. 0 … 10 s.
  double reorder_window_s = 0.2;
  /// A topic's stamps that go back by more than this, or forward by more than clock_jump_forward_s beyond the time
  /// that passed in the log, count as a clock jump: a new segment begins. 0.1 … 3600 s.
  double clock_jump_back_s = 1.0;
  double clock_jump_forward_s = 60.0;  ///< 1 … 1e6 s
  /// Which segment between clock jumps to deliver, from 0; LogReport::segments lists them all.
  int segment = 0;
  bool require_lidar = true;  ///< a log without a single lidar message is an error
  bool require_imu = true;
  Progress* progress = nullptr;  ///< counts bytes of the file; may cancel
  Result<void> validate() const;
};

/// Delivers the messages of the rig's topics to `sink`, each topic in the order of its stamps, topics interleaved as
/// they were recorded, and no message twice: times of every sensor but the lidar ascend strictly. Memory does not grow
/// with the log.
/// Ranges follow REP 117 after the rig's `no_return`, min_range_m and max_range_m: +inf nothing up to max_range_m,
/// -inf closer than min_range_m, NaN invalid. The stamps are those of the messages: the rig's time offsets are left
/// to the consumer. The LidarScan is reused between calls.
/// Errors: bad_input (not a bag; a topic that the rig needs is missing or of another type; a GPS topic that is missing
/// where the log has others; point clouds without time per point; nothing usable), usage (options; max_range_m above
/// what the lidar reports; joint not in the log), interrupted, resources. Damage to the file is not an error: it is in
/// the report.
Result<LogReport> read_log(const std::string& path, const Rig& rig, SensorSink& sink, const LogOptions& options = {});

}  // namespace rayfield::formats
