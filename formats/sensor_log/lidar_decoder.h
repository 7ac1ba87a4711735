#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "formats/rosbag/ros_messages.h"
#include "formats/sensor_log/beam_geometry.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/formats/sensor_log.h"

namespace rayfield::formats {

enum class DecodeState { usable, undecodable, invalid };

/// Turns LaserScan and PointCloud2 messages into LidarScan under a rig's range convention.
class LidarDecoder {
 public:
  explicit LidarDecoder(const Rig::Lidar& lidar) : lidar_(lidar) {}

  /// Decodes into scan(); `stamp_ns` replaces the header's stamp. An invalid scan has not a single usable measurement.
  /// Errors: bad_input, usage (without `where`, which the caller knows).
  Result<DecodeState> laser_scan(std::span<const std::byte> message, std::int64_t stamp_ns);
  Result<DecodeState> point_cloud2(std::span<const std::byte> message, std::int64_t stamp_ns);

  const LidarScan& scan() const { return scan_; }
  const LidarPointCounts& counts() const { return counts_; }

 private:
  float classified(float range_m);
  DecodeState judged(const LidarPointCounts& before) const;
  void use_pattern(const LaserScanView& view);
  bool is_gap(double range_m) const;
  void fill_gaps();

  /// A shot without a return, in scan_ without its direction.
  struct Gap {
    std::size_t index;
    std::uint16_t ring;
    bool at_origin;
  };

  Rig::Lidar lidar_;
  LidarScan scan_;
  LidarPointCounts counts_;
  // The pattern whose directions and times scan_ holds: a lidar keeps the same one from scan to scan.
  bool has_pattern_ = false;
  float angle_min_ = 0, angle_increment_ = 0, time_increment_ = 0;
  // Of the cloud at hand.
  BeamGeometry beams_;
  std::vector<BeamGeometry::Shot> shots_;
  std::vector<Gap> gaps_;
};

/// Reads a field of any type as a double.
inline double point_value(const std::byte* point, const PointFieldView& field) {
  const std::byte* at = point + field.offset;
  switch (field.type) {
    case PointType::i8:
      return static_cast<double>(load<std::int8_t>(at));
    case PointType::u8:
      return static_cast<double>(load<std::uint8_t>(at));
    case PointType::i16:
      return static_cast<double>(load<std::int16_t>(at));
    case PointType::u16:
      return static_cast<double>(load<std::uint16_t>(at));
    case PointType::i32:
      return static_cast<double>(load<std::int32_t>(at));
    case PointType::u32:
      return static_cast<double>(load<std::uint32_t>(at));
    case PointType::f32:
      return static_cast<double>(load<float>(at));
    case PointType::f64:
      return load<double>(at);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// Time of each point of a cloud relative to the stamp of its message.
class PointTime {
 public:
  /// Finds the field that carries time per point (time, t, timestamp, offset_time and the like; docs/rosbag.md) and
  /// its unit. Errors: bad_input where the cloud has none.
  static Result<PointTime> find(const PointCloud2View& cloud, std::int64_t stamp_ns);
  /// Seconds after the stamp.
  double offset_s(const std::byte* point) const { return (point_value(point, field_) - base_) * factor_ - rest_s_; }

 private:
  PointFieldView field_;
  double base_ = 0, factor_ = 1, rest_s_ = 0;
};

}  // namespace rayfield::formats
