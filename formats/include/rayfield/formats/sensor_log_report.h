#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "rayfield/formats/rosbag_reader.h"

/// What became of the messages of a log while it was read.
namespace rayfield::formats {

enum class SensorKind { imu, gps, spinner, lidar };
inline constexpr std::array<SensorKind, 4> kSensorKinds = {SensorKind::imu, SensorKind::gps, SensorKind::spinner,
                                                           SensorKind::lidar};

/// What became of the messages of one topic.
struct TopicReport {
  std::string topic;
  std::string type;                       ///< empty where the topic is not in the log
  std::uint64_t messages = 0;             ///< in the log
  std::uint64_t delivered = 0;            ///< to the sink
  std::uint64_t duplicates = 0;           ///< same stamp as the one before (and, for a lidar, same content): left out
  std::uint64_t reordered = 0;            ///< came after a later stamp and were put back in order
  std::uint64_t late = 0;                 ///< came later than the window allows: left out
  std::uint64_t stray_stamps = 0;         ///< a single stamp far from its neighbours: left out
  std::uint64_t without_stamp = 0;        ///< stamp 0: the recording time was taken
  std::uint64_t other_segments = 0;       ///< on the other side of a clock jump: left out
  std::uint64_t undecodable = 0;          ///< lengths do not fit: left out
  std::uint64_t invalid = 0;              ///< NaN or impossible values throughout: left out
  std::uint64_t without_position = 0;     ///< GPS without a fix: left out
  double first_s = 0, last_s = 0;         ///< stamps delivered
  double longest_gap_s = 0;               ///< between two delivered stamps
  double longest_gap_start_s = 0;         ///< stamp before it
  double longest_stationary_s = 0;        ///< of a spinner: how long its angle stayed the same
  double longest_stationary_start_s = 0;  ///< stamp where that began
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
  std::uint64_t later_echoes = 0;       ///< behind the first of their beams: left out, and not among the points
  std::uint64_t zeros = 0;              ///< ranges written as exactly 0, whatever they count as
};

/// The part of a log between two clock jumps.
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

}  // namespace rayfield::formats
