#pragma once

#include <string>
#include <string_view>

namespace rayfield::formats {

/// A message type with the full text of its definition, as a bag has to carry it.
struct RosDefinition {
  std::string type;
  std::string md5sum;
  std::string text;
};

const RosDefinition& laser_scan_definition();
const RosDefinition& point_cloud2_definition();
const RosDefinition& imu_definition();
const RosDefinition& nav_sat_fix_definition();
const RosDefinition& joint_state_definition();
const RosDefinition& multi_echo_laser_scan_definition();
/// The definition of a type that rayfield reads; null for others.
const RosDefinition* find_ros_definition(std::string_view type);

}  // namespace rayfield::formats
