#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/formats/rosbag_reader.h"
#include "rayfield/formats/sensor_log.h"

namespace rayfield::formats {

/// What to do with a log of raw packets.
inline constexpr const char* kDecodeRawPackets =
    "play the bag through the sensor's ROS driver, record its PointCloud2 with time per point, and give that bag";

/// "lidar", "IMU" … for messages.
std::string_view sensor_name(SensorKind kind);

/// True for types that hold a sensor's raw network packets or a vendor's own messages instead of measurements.
bool is_raw_packets(std::string_view type);

/// Which sensor a message type can serve; several types serve the lidar.
bool serves(std::string_view type, SensorKind kind);

/// Errors: bad_input where the connection's type, or its definition's md5sum, is not one that the sensor can use.
Result<void> check_sensor_topic(SensorKind kind, const BagConnection& connection, const std::string& path);

/// The error for a sensor whose topic is not in the log: names the topics that could be meant, or the raw packets.
tl::unexpected<Error> missing_sensor_topic(SensorKind kind, const std::string& topic,
                                           const std::vector<BagConnection>& connections, const std::string& path);

}  // namespace rayfield::formats
