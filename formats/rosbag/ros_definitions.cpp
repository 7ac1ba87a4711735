#include "formats/rosbag/ros_definitions.h"

#include <array>
#include <initializer_list>

namespace rayfield::formats {
namespace {

/// A dependency's text follows the definition behind a line of 80 '=' and its name. The md5sums are those of the
/// definitions in ROS 1 (sensor_msgs 1.13); comments do not enter into them.
std::string with(const std::string& text, std::initializer_list<const char*> dependencies) {
  std::string full = text;
  for (const char* dependency : dependencies) full += std::string(80, '=') + "\nMSG: " + dependency;
  return full;
}

constexpr const char* kHeader = R"(std_msgs/Header
uint32 seq
time stamp
string frame_id
)";

constexpr const char* kQuaternion = R"(geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
)";

constexpr const char* kVector3 = R"(geometry_msgs/Vector3
float64 x
float64 y
float64 z
)";

constexpr const char* kPointField = R"(sensor_msgs/PointField
uint8 INT8    = 1
uint8 UINT8   = 2
uint8 INT16   = 3
uint8 UINT16  = 4
uint8 INT32   = 5
uint8 UINT32  = 6
uint8 FLOAT32 = 7
uint8 FLOAT64 = 8
string name
uint32 offset
uint8  datatype
uint32 count
)";

constexpr const char* kLaserEcho = R"(sensor_msgs/LaserEcho
float32[] echoes
)";

constexpr const char* kNavSatStatus = R"(sensor_msgs/NavSatStatus
int8 STATUS_NO_FIX =  -1
int8 STATUS_FIX =      0
int8 STATUS_SBAS_FIX = 1
int8 STATUS_GBAS_FIX = 2
int8 status
uint16 SERVICE_GPS =     1
uint16 SERVICE_GLONASS = 2
uint16 SERVICE_COMPASS = 4
uint16 SERVICE_GALILEO = 8
uint16 service
)";

/// The texts as rosbag stores them; the md5sums hold for these and no others.
const std::array<RosDefinition, 6>& definitions() {
  static const std::array<RosDefinition, 6> kAll = {
      {{"sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369",
        with(R"(Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities
)",
             {kHeader})},
       {"sensor_msgs/PointCloud2", "1158d486dd51d683ce2f1be655c3c181",
        with(R"(Header header
uint32 height
uint32 width
PointField[] fields
bool    is_bigendian
uint32  point_step
uint32  row_step
uint8[] data
bool is_dense
)",
             {kHeader, kPointField})},
       {"sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2",
        with(R"(Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
)",
             {kHeader, kQuaternion, kVector3})},
       {"sensor_msgs/NavSatFix", "2d3a8cd499b9b4a0249fb98fd05cfa48",
        with(R"(Header header
NavSatStatus status
float64 latitude
float64 longitude
float64 altitude
float64[9] position_covariance
uint8 COVARIANCE_TYPE_UNKNOWN = 0
uint8 COVARIANCE_TYPE_APPROXIMATED = 1
uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN = 2
uint8 COVARIANCE_TYPE_KNOWN = 3
uint8 position_covariance_type
)",
             {kHeader, kNavSatStatus})},
       {"sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd",
        with(R"(Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
)",
             {kHeader})},
       {"sensor_msgs/MultiEchoLaserScan", "6fefb0c6da89d7c8abe4b339f5c2f8fb",
        with(R"(Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
LaserEcho[] ranges
LaserEcho[] intensities
)",
             {kHeader, kLaserEcho})}}};
  return kAll;
}

}  // namespace

const RosDefinition& laser_scan_definition() { return definitions()[0]; }
const RosDefinition& point_cloud2_definition() { return definitions()[1]; }
const RosDefinition& imu_definition() { return definitions()[2]; }
const RosDefinition& nav_sat_fix_definition() { return definitions()[3]; }
const RosDefinition& joint_state_definition() { return definitions()[4]; }
const RosDefinition& multi_echo_laser_scan_definition() { return definitions()[5]; }

const RosDefinition* find_ros_definition(std::string_view type) {
  for (const RosDefinition& definition : definitions()) {
    if (definition.type == type) return &definition;
  }
  return nullptr;
}

}  // namespace rayfield::formats
