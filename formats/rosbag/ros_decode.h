#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "formats/rosbag/ros_header.h"
#include "rayfield/core/sensor_log.h"

/// The sensor_msgs that rayfield reads, in ROS 1 serialisation: fields in order, little-endian, no padding, strings and
/// arrays with a u32 count in front. A message that is not exactly as long as its own counts say gives nothing.
namespace rayfield::formats {

/// The time_s of the results is the header's stamp.
std::optional<ImuSample> decode_imu(std::span<const std::byte> message);
std::optional<GpsFix> decode_nav_sat_fix(std::span<const std::byte> message);

struct JointStateView {
  RosHeader header;
  std::vector<std::string_view> name;
  std::span<const std::byte> position;  ///< float64[]
};
std::optional<JointStateView> decode_joint_state(std::span<const std::byte> message);
/// Position of a joint; nothing where the message does not have it.
std::optional<double> joint_position(const JointStateView& state, std::string_view joint);

/// What scans in a plane say of their beams.
struct PlaneScanView {
  RosHeader header;
  float angle_min = 0, angle_max = 0, angle_increment = 0, time_increment = 0, scan_time = 0;
  float range_min = 0, range_max = 0;
};

struct LaserScanView : PlaneScanView {
  std::span<const std::byte> ranges, intensities;  ///< float32[]
  std::size_t beams() const { return ranges.size() / sizeof(float); }
};
std::optional<LaserScanView> decode_laser_scan(std::span<const std::byte> message);

struct MultiEchoLaserScanView : PlaneScanView {
  std::vector<std::span<const std::byte>> ranges, intensities;  ///< of each beam, float32[] of its echoes
  std::size_t beams() const { return ranges.size(); }
};
std::optional<MultiEchoLaserScanView> decode_multi_echo_laser_scan(std::span<const std::byte> message);

}  // namespace rayfield::formats
