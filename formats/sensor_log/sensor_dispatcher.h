#pragma once

#include <array>
#include <cstddef>
#include <set>
#include <string>

#include "formats/sensor_log/lidar_decoder.h"
#include "formats/sensor_log/reorder_buffer.h"
#include "formats/sensor_log/stationary_detector.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/formats/sensor_log_report.h"

namespace rayfield::formats {

/// Decodes ordered messages and hands them to the sink; keeps the counts that arise there.
class SensorDispatcher {
 public:
  SensorDispatcher(const std::string& path, const Rig& rig, SensorSink& sink)
      : path_(path), rig_(rig), sink_(sink), lidar_(rig.lidar) {}

  Result<void> dispatch(SensorKind kind, const BufferedMessage& message);
  TopicReport& topic(SensorKind kind) { return topics_[static_cast<std::size_t>(kind)]; }
  const LidarPointCounts& points() const { return lidar_.counts(); }
  /// Joints that messages of the spinner's topic name and the rig does not; at most 16.
  const std::set<std::string>& other_joints() const { return other_joints_; }

 private:
  Result<DecodeState> decode(SensorKind kind, const BufferedMessage& message);
  DecodeState decode_imu_message(const BufferedMessage& message);
  DecodeState decode_gps_message(const BufferedMessage& message);
  DecodeState decode_spinner_message(const BufferedMessage& message);

  std::string path_;
  const Rig& rig_;
  SensorSink& sink_;
  LidarDecoder lidar_;
  std::array<TopicReport, 4> topics_;
  std::set<std::string> other_joints_;
  StationaryDetector stationary_;
};

}  // namespace rayfield::formats
