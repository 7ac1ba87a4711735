#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/rosbag/point_cloud2.h"
#include "formats/rosbag/ros_decode.h"
#include "formats/sensor_log/beam_geometry.h"
#include "formats/sensor_log/first_echoes.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/formats/sensor_log_report.h"

namespace rayfield::formats {

enum class DecodeState { usable, undecodable, invalid };

/// Turns LaserScan, MultiEchoLaserScan and PointCloud2 messages into LidarScan under a rig's range convention.
class LidarDecoder {
 public:
  explicit LidarDecoder(const Rig::Lidar& lidar) : lidar_(lidar) {}

  /// Decodes into scan(); `stamp_ns` replaces the header's stamp. An invalid scan has not a single usable measurement.
  /// Errors: bad_input, usage (without `where`, which the caller knows).
  Result<DecodeState> laser_scan(std::span<const std::byte> message, std::int64_t stamp_ns);
  Result<DecodeState> multi_echo_laser_scan(std::span<const std::byte> message, std::int64_t stamp_ns);
  Result<DecodeState> point_cloud2(std::span<const std::byte> message, std::int64_t stamp_ns);

  const LidarScan& scan() const { return scan_; }
  const LidarPointCounts& counts() const { return counts_; }

 private:
  float classify(float range_m);
  DecodeState state_since(const LidarPointCounts& before) const;
  /// Usable where the beams of a scan in a plane lie as directions and times.
  Result<DecodeState> begin_plane_scan(const PlaneScanView& view, std::size_t beams, std::int64_t stamp_ns);
  void use_pattern(const PlaneScanView& view, std::size_t beams);
  Result<bool> collect_points(const PointCloud2View& cloud, std::int64_t stamp_ns);
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
  std::vector<float> echoes_;  // of one beam
  // Of the cloud at hand.
  BeamGeometry beams_;
  std::vector<CloudPoint> points_;
  bool has_intensity_ = false;
  std::vector<BeamGeometry::Shot> shots_;
  std::vector<Gap> gaps_;
};

}  // namespace rayfield::formats
