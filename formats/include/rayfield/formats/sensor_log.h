#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/formats/rosbag_reader.h"

/// Reading the sensors of a rig from a log (docs/rosbag.md): sensor_msgs LaserScan or PointCloud2, Imu, NavSatFix,
/// JointState from ROS 1 bags.
namespace rayfield::formats {

enum class SensorKind { imu, gps, spinner, lidar };
inline constexpr std::array<SensorKind, 4> kSensorKinds = {SensorKind::imu, SensorKind::gps, SensorKind::spinner,
                                                           SensorKind::lidar};

struct LogOptions {
  BagReadOptions bag;
  /// Messages of a topic are brought into the order of their stamps when they come up to this late; later ones are
  /// left out. Memory holds this much of the log. 0 … 10 s.
  double reorder_window_s = 0.2;
  /// A topic's stamps that go back by more than this, or forward by more than clock_jump_forward_s beyond the time
  /// that passed in the log, are a jump of its clock: a new segment begins. 0.1 … 3600 s.
  double clock_jump_back_s = 1.0;
  double clock_jump_forward_s = 60.0;  ///< 1 … 1e6 s
  /// Which segment between clock jumps to deliver, from 0; LogReport::segments lists them all.
  int segment = 0;
  bool require_lidar = true;  ///< a log without a single lidar message is an error
  bool require_imu = true;
  Progress* progress = nullptr;  ///< counts bytes of the file; may cancel
  Result<void> validate() const;
};

/// What became of the messages of one topic.
struct TopicReport {
  std::string topic;
  std::string type;                    ///< empty where the topic is not in the log
  std::uint64_t messages = 0;          ///< in the log
  std::uint64_t delivered = 0;         ///< to the sink
  std::uint64_t duplicates = 0;        ///< same stamp as the one before (and, for a lidar, same content): left out
  std::uint64_t reordered = 0;         ///< came after a later stamp and were put back in order
  std::uint64_t late = 0;              ///< came later than the window allows: left out
  std::uint64_t stray_stamps = 0;      ///< a single stamp far from its neighbours: left out
  std::uint64_t without_stamp = 0;     ///< stamp 0: the recording time was taken
  std::uint64_t other_segments = 0;    ///< on the other side of a clock jump: left out
  std::uint64_t undecodable = 0;       ///< lengths do not fit: left out
  std::uint64_t invalid = 0;           ///< NaN or impossible values throughout: left out
  std::uint64_t without_position = 0;  ///< GPS without a fix: left out
  double first_s = 0, last_s = 0;      ///< stamps delivered
  double longest_gap_s = 0;            ///< between two delivered stamps
  double longest_gap_start_s = 0;      ///< stamp before it
  double longest_still_s = 0;          ///< of a spinner: how long its angle stayed the same
  double longest_still_start_s = 0;    ///< stamp where that began
};

/// The fate of single lidar measurements. points = returns + no_returns + too_close + invalid + without_direction.
struct LidarPointCounts {
  std::uint64_t points = 0;
  std::uint64_t returns = 0;            ///< range within the rig's limits
  std::uint64_t no_returns = 0;         ///< nothing within max_range_m; those that hit beyond it included
  std::uint64_t too_close = 0;          ///< below min_range_m
  std::uint64_t invalid = 0;            ///< NaN, negative, or a time outside the scan
  std::uint64_t restored = 0;           ///< of no_returns: points of a cloud whose direction followed from the others
  std::uint64_t without_direction = 0;  ///< points at the origin of a cloud: left out
  std::uint64_t zeros = 0;              ///< ranges written as exactly 0, whatever they count as
};

/// A stretch of the log between two clock jumps.
struct LogSegment {
  double first_s = 0, last_s = 0;  ///< stamps of the IMU, or of the lidar where there is no IMU
  std::uint64_t messages = 0;
};

struct LogReport {
  BagSummary bag;
  std::array<TopicReport, 4> topics;  ///< by SensorKind
  LidarPointCounts points;
  std::vector<LogSegment> segments;  ///< one without clock jumps
  int segment = 0;                   ///< the one that was delivered
  int longest_segment = 0;           ///< index into segments, by duration
  const TopicReport& topic(SensorKind kind) const { return topics[static_cast<std::size_t>(kind)]; }
  /// Everything that a user should know, one line each; empty for a clean log.
  std::vector<std::string> warnings() const;
};

/// Delivers the messages of the rig's topics to `sink`, each topic in the order of its stamps, topics interleaved as
/// they were recorded, and no message twice. Memory does not grow with the log.
/// Ranges follow REP 117 after the rig's `no_return`, min_range_m and max_range_m: +inf nothing up to max_range_m,
/// -inf closer than min_range_m, NaN invalid. The stamps are those of the messages: the rig's time offsets are left
/// to the consumer. The LidarScan is reused between calls.
/// Errors: bad_input (not a bag; a topic that the rig needs is missing or of another type; a GPS topic that is missing
/// where the log has others; point clouds without time per point; nothing usable), usage (options; max_range_m above
/// what the lidar reports; joint not in the log), interrupted, resources. Damage to the file is no error: it is in the
/// report.
Result<LogReport> read_log(const std::string& path, const Rig& rig, SensorSink& sink, const LogOptions& options = {});

}  // namespace rayfield::formats
