#include "formats/sensor_log/sensor_topics.h"

#include <array>

#include "formats/rosbag/ros_definitions.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot read log";

}  // namespace

std::string_view sensor_name(SensorKind kind) {
  switch (kind) {
    case SensorKind::imu:
      return "IMU";
    case SensorKind::gps:
      return "GPS";
    case SensorKind::spinner:
      return "spinner";
    case SensorKind::lidar:
      break;
  }
  return "lidar";
}

bool is_raw_packets(std::string_view type) {
  constexpr std::array<std::string_view, 13> kRaw = {
      "ouster_ros/PacketMsg",       "velodyne_msgs/VelodyneScan",  "velodyne_msgs/VelodynePacket",
      "hesai_lidar/PandarScan",     "pandar_msgs/PandarScan",      "hesai_ros_driver/UdpFrame",
      "livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg", "rslidar_msgs/rslidarScan",
      "rslidar_msgs/rslidarPacket", "rs_driver/RslidarPacket",     "rslidar_msg/RslidarPacket",
      "lslidar_msgs/LslidarPacket"};
  for (const std::string_view each : kRaw) {
    if (type == each) return true;
  }
  return false;
}

bool serves(std::string_view type, SensorKind kind) {
  switch (kind) {
    case SensorKind::imu:
      return type == imu_definition().type;
    case SensorKind::gps:
      return type == nav_sat_fix_definition().type;
    case SensorKind::spinner:
      return type == joint_state_definition().type;
    case SensorKind::lidar:
      break;
  }
  return type == laser_scan_definition().type || type == multi_echo_laser_scan_definition().type ||
         type == point_cloud2_definition().type;
}

Result<void> check_sensor_topic(SensorKind kind, const BagConnection& connection, const std::string& path) {
  const std::string where = path + ", topic " + connection.topic;
  if (is_raw_packets(connection.type)) {
    return fail(ErrorCode::bad_input, kWhat, where, "it holds a sensor's raw packets (" + connection.type + ")",
                kDecodeRawPackets);
  }
  if (!serves(connection.type, kind)) {
    return fail(ErrorCode::bad_input, kWhat, where,
                "its type " + connection.type + " does not serve as " + std::string(sensor_name(kind)),
                "name another topic in the rig file");
  }
  const RosDefinition* definition = find_ros_definition(connection.type);
  if (connection.md5sum != "*" && connection.md5sum != definition->md5sum) {
    return fail(ErrorCode::bad_input, kWhat, where,
                "its definition of " + connection.type + " (md5sum " + connection.md5sum +
                    ") is not the one of ROS 1 (" + definition->md5sum + ")");
  }
  return {};
}

tl::unexpected<Error> missing_sensor_topic(SensorKind kind, const std::string& topic,
                                           const std::vector<BagConnection>& connections, const std::string& path) {
  std::string fitting, raw;
  for (const BagConnection& connection : connections) {
    std::string* list = serves(connection.type, kind) ? &fitting : is_raw_packets(connection.type) ? &raw : nullptr;
    if (list != nullptr) *list += (list->empty() ? "" : ", ") + connection.topic + " (" + connection.type + ")";
  }
  std::string why = "the log has no " + std::string(sensor_name(kind)) + " topic " + topic;
  const std::string otherwise = kind == SensorKind::gps ? "; or leave [gps] out: nothing is georeferenced then" : "";
  if (!fitting.empty())
    return fail(ErrorCode::bad_input, kWhat, path, why, "in the rig file, choose from: " + fitting + otherwise);
  if (kind == SensorKind::lidar && !raw.empty()) {
    return fail(ErrorCode::bad_input, kWhat, path, why + ", only a sensor's raw packets: " + raw, kDecodeRawPackets);
  }
  return fail(ErrorCode::bad_input, kWhat, path, why + ", and no other topic that could serve",
              "see `rayfield info` for what the log holds");
}

}  // namespace rayfield::formats
