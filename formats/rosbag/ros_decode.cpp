#include "formats/rosbag/ros_decode.h"

namespace rayfield::formats {
namespace {

Eigen::Vector3d take_vector3(ByteCursor& cursor) {
  const double x = cursor.get<double>();
  const double y = cursor.get<double>();
  const double z = cursor.get<double>();
  return {x, y, z};
}

void take_plane_scan(ByteCursor& cursor, PlaneScanView& scan) {
  scan.header = take_ros_header(cursor);
  scan.angle_min = cursor.get<float>();
  scan.angle_max = cursor.get<float>();
  scan.angle_increment = cursor.get<float>();
  scan.time_increment = cursor.get<float>();
  scan.scan_time = cursor.get<float>();
  scan.range_min = cursor.get<float>();
  scan.range_max = cursor.get<float>();
}

/// sensor_msgs/LaserEcho[]. Each takes four bytes at least, so a wrong count cannot ask for more than the message
/// holds.
bool take_echoes(ByteCursor& cursor, std::vector<std::span<const std::byte>>& beams) {
  const std::size_t count = cursor.get<std::uint32_t>();
  if (count > cursor.remaining() / sizeof(std::uint32_t)) return false;
  beams.reserve(count);
  for (std::size_t i = 0; i < count; ++i) beams.push_back(cursor.take_array<float>());
  return true;
}

/// True once a message has been read to its last byte and no further.
bool complete(const ByteCursor& cursor) { return !cursor.failed() && cursor.remaining() == 0; }

}  // namespace

std::optional<ImuSample> decode_imu(std::span<const std::byte> message) {
  ByteCursor cursor(message);
  ImuSample sample;
  sample.time_s = seconds_from_ns(take_ros_header(cursor).stamp_ns);
  cursor.skip((4 + 9) * sizeof(double));  // orientation and its covariance: SLAM finds it itself
  sample.angular_velocity_rad_s = take_vector3(cursor);
  cursor.skip(9 * sizeof(double));
  sample.linear_acceleration_m_s2 = take_vector3(cursor);
  cursor.skip(9 * sizeof(double));
  if (!complete(cursor)) return std::nullopt;
  return sample;
}

std::optional<GpsFix> decode_nav_sat_fix(std::span<const std::byte> message) {
  ByteCursor cursor(message);
  GpsFix fix;
  fix.time_s = seconds_from_ns(take_ros_header(cursor).stamp_ns);
  // A number and no character: −1 is "no fix". NOLINTNEXTLINE(bugprone-signed-char-misuse)
  fix.status = cursor.get<std::int8_t>();
  cursor.skip(sizeof(std::uint16_t));  // service
  fix.latitude_deg = cursor.get<double>();
  fix.longitude_deg = cursor.get<double>();
  fix.height_m = cursor.get<double>();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) fix.covariance_enu_m2(row, column) = cursor.get<double>();
  }
  fix.covariance_type = cursor.get<std::uint8_t>();
  if (!complete(cursor)) return std::nullopt;
  return fix;
}

std::optional<JointStateView> decode_joint_state(std::span<const std::byte> message) {
  ByteCursor cursor(message);
  JointStateView state;
  state.header = take_ros_header(cursor);
  const std::size_t names = cursor.get<std::uint32_t>();
  // Every name takes four bytes at least, so a wrong count cannot ask for more than the message holds.
  if (names > cursor.remaining() / 4) return std::nullopt;
  state.name.reserve(names);
  for (std::size_t i = 0; i < names; ++i) state.name.push_back(cursor.text());
  state.position = cursor.take_array<double>();
  cursor.take_array<double>();  // velocity
  cursor.take_array<double>();  // effort
  if (!complete(cursor)) return std::nullopt;
  return state;
}

std::optional<double> joint_position(const JointStateView& state, std::string_view joint) {
  for (std::size_t i = 0; i < state.name.size(); ++i) {
    if (state.name[i] != joint) continue;
    if ((i + 1) * sizeof(double) > state.position.size()) return std::nullopt;
    return load<double>(state.position.data() + i * sizeof(double));
  }
  return std::nullopt;
}

std::optional<LaserScanView> decode_laser_scan(std::span<const std::byte> message) {
  ByteCursor cursor(message);
  LaserScanView scan;
  take_plane_scan(cursor, scan);
  scan.ranges = cursor.take_array<float>();
  scan.intensities = cursor.take_array<float>();
  if (!complete(cursor)) return std::nullopt;
  return scan;
}

std::optional<MultiEchoLaserScanView> decode_multi_echo_laser_scan(std::span<const std::byte> message) {
  ByteCursor cursor(message);
  MultiEchoLaserScanView scan;
  take_plane_scan(cursor, scan);
  if (!take_echoes(cursor, scan.ranges) || !take_echoes(cursor, scan.intensities) || !complete(cursor))
    return std::nullopt;
  return scan;
}

}  // namespace rayfield::formats
