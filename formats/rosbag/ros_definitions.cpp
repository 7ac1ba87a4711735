#include <array>

#include "formats/rosbag/ros_messages.h"

namespace rayfield::formats {
namespace {

/// A dependency's text follows the definition behind a line of 80 '=' and its name. The md5sums are those of the
/// definitions in ROS 1 (sensor_msgs 1.13); comments do not enter into them.
std::string with(const std::string& text, std::initializer_list<const char*> dependencies) {
  std::string full = text;
  for (const char* dependency : dependencies) full += std::string(80, '=') + "\nMSG: " + dependency;
  return full;
}

constexpr const char* kHeader =
    "std_msgs/Header\n"
    "uint32 seq\n"
    "time stamp\n"
    "string frame_id\n";

constexpr const char* kQuaternion =
    "geometry_msgs/Quaternion\n"
    "float64 x\n"
    "float64 y\n"
    "float64 z\n"
    "float64 w\n";

constexpr const char* kVector3 =
    "geometry_msgs/Vector3\n"
    "float64 x\n"
    "float64 y\n"
    "float64 z\n";

constexpr const char* kPointField =
    "sensor_msgs/PointField\n"
    "uint8 INT8    = 1\n"
    "uint8 UINT8   = 2\n"
    "uint8 INT16   = 3\n"
    "uint8 UINT16  = 4\n"
    "uint8 INT32   = 5\n"
    "uint8 UINT32  = 6\n"
    "uint8 FLOAT32 = 7\n"
    "uint8 FLOAT64 = 8\n"
    "string name\n"
    "uint32 offset\n"
    "uint8  datatype\n"
    "uint32 count\n";

constexpr const char* kNavSatStatus =
    "sensor_msgs/NavSatStatus\n"
    "int8 STATUS_NO_FIX =  -1\n"
    "int8 STATUS_FIX =      0\n"
    "int8 STATUS_SBAS_FIX = 1\n"
    "int8 STATUS_GBAS_FIX = 2\n"
    "int8 status\n"
    "uint16 SERVICE_GPS =     1\n"
    "uint16 SERVICE_GLONASS = 2\n"
    "uint16 SERVICE_COMPASS = 4\n"
    "uint16 SERVICE_GALILEO = 8\n"
    "uint16 service\n";

}  // namespace

const RosDefinition& laser_scan_definition() {
  static const RosDefinition definition = {"sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369",
                                           with("Header header\n"
                                                "float32 angle_min\n"
                                                "float32 angle_max\n"
                                                "float32 angle_increment\n"
                                                "float32 time_increment\n"
                                                "float32 scan_time\n"
                                                "float32 range_min\n"
                                                "float32 range_max\n"
                                                "float32[] ranges\n"
                                                "float32[] intensities\n",
                                                {kHeader})};
  return definition;
}

const RosDefinition& point_cloud2_definition() {
  static const RosDefinition definition = {"sensor_msgs/PointCloud2", "1158d486dd51d683ce2f1be655c3c181",
                                           with("Header header\n"
                                                "uint32 height\n"
                                                "uint32 width\n"
                                                "PointField[] fields\n"
                                                "bool    is_bigendian\n"
                                                "uint32  point_step\n"
                                                "uint32  row_step\n"
                                                "uint8[] data\n"
                                                "bool is_dense\n",
                                                {kHeader, kPointField})};
  return definition;
}

const RosDefinition& imu_definition() {
  static const RosDefinition definition = {"sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2",
                                           with("Header header\n"
                                                "geometry_msgs/Quaternion orientation\n"
                                                "float64[9] orientation_covariance\n"
                                                "geometry_msgs/Vector3 angular_velocity\n"
                                                "float64[9] angular_velocity_covariance\n"
                                                "geometry_msgs/Vector3 linear_acceleration\n"
                                                "float64[9] linear_acceleration_covariance\n",
                                                {kHeader, kQuaternion, kVector3})};
  return definition;
}

const RosDefinition& nav_sat_fix_definition() {
  static const RosDefinition definition = {"sensor_msgs/NavSatFix", "2d3a8cd499b9b4a0249fb98fd05cfa48",
                                           with("Header header\n"
                                                "NavSatStatus status\n"
                                                "float64 latitude\n"
                                                "float64 longitude\n"
                                                "float64 altitude\n"
                                                "float64[9] position_covariance\n"
                                                "uint8 COVARIANCE_TYPE_UNKNOWN = 0\n"
                                                "uint8 COVARIANCE_TYPE_APPROXIMATED = 1\n"
                                                "uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN = 2\n"
                                                "uint8 COVARIANCE_TYPE_KNOWN = 3\n"
                                                "uint8 position_covariance_type\n",
                                                {kHeader, kNavSatStatus})};
  return definition;
}

const RosDefinition& joint_state_definition() {
  static const RosDefinition definition = {"sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd",
                                           with("Header header\n"
                                                "string[] name\n"
                                                "float64[] position\n"
                                                "float64[] velocity\n"
                                                "float64[] effort\n",
                                                {kHeader})};
  return definition;
}

const RosDefinition* find_ros_definition(std::string_view type) {
  static const std::array<const RosDefinition*, 5> known = {&laser_scan_definition(), &point_cloud2_definition(),
                                                            &imu_definition(), &nav_sat_fix_definition(),
                                                            &joint_state_definition()};
  for (const RosDefinition* definition : known) {
    if (definition->type == type) return definition;
  }
  return nullptr;
}

}  // namespace rayfield::formats
