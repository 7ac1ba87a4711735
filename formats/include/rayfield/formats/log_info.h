#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/formats/rosbag_reader.h"
#include "rayfield/formats/sensor_log.h"

/// What is in a log, whether rayfield can use it or not: `rayfield info LOG`.
namespace rayfield::formats {

/// One topic. Times are the stamps of the messages where their type begins with a header, else when they were recorded.
struct TopicInfo {
  std::string topic, type;
  std::string frame_id;  ///< of the first message, where it has one
  bool has_stamps = false;
  std::uint64_t messages = 0;
  double first_s = 0, last_s = 0;
  double rate_hz = 0;  ///< from the median of the first 1000 intervals; 0 with fewer than two messages
  double longest_gap_s = 0;
  std::uint64_t clock_jumps = 0;  ///< of its stamps (LogOptions); neither gaps nor backwards
  std::uint64_t gaps = 0;         ///< intervals over five times the usual one and over 0.1 s
  std::uint64_t backwards = 0;    ///< stamps earlier than the one before
  std::uint64_t repeated = 0;     ///< stamps equal to the one before
  std::uint64_t unstamped = 0;    ///< stamps of 0
  std::uint64_t undecodable = 0;  ///< of the types that rayfield reads
  bool raw_packets = false;       ///< a sensor's own packets, which have to be decoded first
};

/// What a lidar's ranges look like, over all LaserScans and MultiEchoLaserScans or every tenth PointCloud2.
struct LidarInfo {
  std::string topic;
  std::uint64_t points = 0;          ///< looked at
  std::uint64_t several_echoes = 0;  ///< beams of MultiEchoLaserScans with more than one; each echo is a point
  std::uint64_t nan = 0, infinite = 0, zero = 0;
  double smallest_m = 0, largest_m = 0;  ///< of the finite ranges above 0
  std::uint64_t at_largest = 0;          ///< points within 0.01 % of largest_m
  double points_per_message = 0;
  std::optional<double> range_min_m, range_max_m;  ///< as LaserScans state them
  std::optional<double> time_increment_s;          ///< of LaserScans
  std::string fields;                              ///< of PointCloud2s
  bool has_point_time = true;  ///< PointCloud2s have a usable time per point; LaserScans do by design
};

struct ImuInfo {
  std::string topic;
  double mean_acceleration_m_s2 = 0;  ///< mean length: about 9.8, or 1 where the driver writes g
  double largest_rate_rad_s = 0;
  std::uint64_t invalid = 0;
};

struct GpsInfo {
  std::string topic;
  std::uint64_t fixes = 0, without_fix = 0;
  double south_deg = 0, north_deg = 0, west_deg = 0, east_deg = 0, lowest_m = 0, highest_m = 0;  ///< of the fixes
};

struct JointInfo {
  std::string topic, joint;
  double travelled_rad = 0;         ///< sum of the absolute steps, wraps of a full turn taken out
  double longest_stationary_s = 0;  ///< how long its angle stayed the same
  /// It goes round: at least one full turn. Others wobble, or are stuck.
  bool turns() const { return travelled_rad >= 2 * std::numbers::pi; }
};

struct LogInfo {
  BagSummary bag;
  std::vector<TopicInfo> topics;  ///< by name
  std::vector<LidarInfo> lidars;
  std::vector<ImuInfo> imus;
  std::vector<GpsInfo> gps;
  std::vector<JointInfo> joints;
  double first_record_s = 0, last_record_s = 0;
  double duration_s = 0;  ///< of the recording, jumps of its clock taken out
  std::uint64_t record_clock_jumps = 0;

  /// What is wrong or missing, one line each; empty for a log that rayfield can use as it is.
  std::vector<std::string> problems() const;
};

/// Reads the whole log once, in bounded memory. Errors: bad_input (not a bag), resources, interrupted, usage.
Result<LogInfo> inspect_log(const std::string& path, const LogOptions& options = {});

}  // namespace rayfield::formats
