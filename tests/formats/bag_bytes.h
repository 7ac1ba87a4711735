#pragma once

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "tests/formats/temporary_file.h"

/// Bags and messages byte by byte, from the public description of the format and independent of the library's writer.
namespace rayfield::formats::bytes {

using testing::read_file;
using testing::shared_folder;
using testing::TemporaryFile;

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class T>
std::string le(T value) {
  std::string out(sizeof(T), '\0');
  std::memcpy(out.data(), &value, sizeof(T));
  return out;
}
inline std::string u8(int value) { return le(static_cast<std::uint8_t>(value)); }
inline std::string u32(std::uint64_t value) { return le(static_cast<std::uint32_t>(value)); }
inline std::string f32(double value) { return le(static_cast<float>(value)); }
inline std::string f64(double value) { return le(value); }
/// A string or array with its length in front.
inline std::string counted(const std::string& text) { return u32(text.size()) + text; }

inline std::string field(const std::string& name, const std::string& value) { return counted(name + "=" + value); }
inline std::string record(const std::string& header, const std::string& data) {
  return counted(header) + counted(data);
}

inline std::string time(std::uint32_t seconds, std::uint32_t nanoseconds) { return u32(seconds) + u32(nanoseconds); }

inline std::string connection(std::uint32_t id, const std::string& topic, const std::string& type,
                              const std::string& md5sum) {
  return record(field("op", u8(7)) + field("conn", u32(id)) + field("topic", topic),
                field("topic", topic) + field("type", type) + field("md5sum", md5sum) +
                    field("message_definition", "Header header\n"));
}
inline std::string message(std::uint32_t id, std::uint32_t seconds, std::uint32_t nanoseconds,
                           const std::string& data) {
  return record(field("conn", u32(id)) + field("op", u8(2)) + field("time", time(seconds, nanoseconds)), data);
}
inline std::string chunk(const std::string& records, const std::string& compression = "none",
                         std::uint64_t size = UINT64_MAX) {
  return record(field("compression", compression) + field("op", u8(5)) +
                    field("size", u32(size == UINT64_MAX ? records.size() : size)),
                records);
}
inline std::string bag_header(std::uint64_t index_pos = 0, const std::string& more = "") {
  const std::string header = field("op", u8(3)) + field("index_pos", le(index_pos)) + field("conn_count", u32(0)) +
                             field("chunk_count", u32(0)) + more;
  return "#ROSBAG V2.0\n" + record(header, std::string(4096 - header.size(), ' '));
}

inline constexpr const char* kImuType = "sensor_msgs/Imu";
inline constexpr const char* kImuMd5 = "6a62c6daae103f4ff57a132d6f95cec2";
inline constexpr const char* kScanType = "sensor_msgs/LaserScan";
inline constexpr const char* kScanMd5 = "90c7ef2dc6895d81024acba2ac42f369";
inline constexpr const char* kMultiEchoType = "sensor_msgs/MultiEchoLaserScan";
inline constexpr const char* kMultiEchoMd5 = "6fefb0c6da89d7c8abe4b339f5c2f8fb";
inline constexpr const char* kCloudType = "sensor_msgs/PointCloud2";
inline constexpr const char* kCloudMd5 = "1158d486dd51d683ce2f1be655c3c181";
inline constexpr const char* kFixType = "sensor_msgs/NavSatFix";
inline constexpr const char* kFixMd5 = "2d3a8cd499b9b4a0249fb98fd05cfa48";
inline constexpr const char* kJointType = "sensor_msgs/JointState";
inline constexpr const char* kJointMd5 = "3066dcd76a6cfaef579bd0f34173e9fd";

inline std::string header(std::uint32_t seconds, std::uint32_t nanoseconds, const std::string& frame = "f") {
  return u32(0) + time(seconds, nanoseconds) + counted(frame);
}
inline std::string doubles(const std::vector<double>& values) {
  std::string out;
  for (const double value : values) out += f64(value);
  return out;
}
inline std::string floats(const std::vector<double>& values) {
  std::string out;
  for (const double value : values) out += f32(value);
  return out;
}
inline std::string zeros(int count) { return doubles(std::vector<double>(static_cast<std::size_t>(count), 0.0)); }

inline std::string imu(std::uint32_t seconds, std::uint32_t nanoseconds, double gyro_x = 0.1, double accel_z = 9.81) {
  return header(seconds, nanoseconds) + zeros(4 + 9) + doubles({gyro_x, 0.2, 0.3}) + zeros(9) +
         doubles({0.4, 0.5, accel_z}) + zeros(9);
}
inline std::string fix(std::uint32_t seconds, std::uint32_t nanoseconds, int status, double latitude, double longitude,
                       double altitude) {
  return header(seconds, nanoseconds) + le(static_cast<std::int8_t>(status)) + le(std::uint16_t{1}) +
         doubles({latitude, longitude, altitude}) + doubles({0.25, 0.01, 0.02, 0.01, 0.36, 0.03, 0.02, 0.03, 0.81}) +
         u8(3);
}
inline std::string joints(std::uint32_t seconds, std::uint32_t nanoseconds, const std::vector<std::string>& names,
                          const std::vector<double>& positions) {
  std::string out = header(seconds, nanoseconds) + u32(names.size());
  for (const std::string& name : names) out += counted(name);
  return out + u32(positions.size()) + doubles(positions) + u32(0) + u32(0);
}
struct ScanNumbers {
  double angle_min = 0, angle_increment = 0, time_increment = 0, range_min = 0.1, range_max = 40;
};
inline std::string scan(std::uint32_t seconds, std::uint32_t nanoseconds, const ScanNumbers& n,
                        const std::vector<double>& ranges, const std::vector<double>& intensities = {}) {
  const double last = n.angle_min + n.angle_increment * (static_cast<double>(ranges.size()) - 1);
  return header(seconds, nanoseconds) +
         floats({n.angle_min, last, n.angle_increment, n.time_increment, 0.01, n.range_min, n.range_max}) +
         u32(ranges.size()) + floats(ranges) + u32(intensities.size()) + floats(intensities);
}
using Echoes = std::vector<std::vector<double>>;  // of each beam
inline std::string multi_echo_scan(std::uint32_t seconds, std::uint32_t nanoseconds, const ScanNumbers& n,
                                   const Echoes& ranges, const Echoes& intensities = {}) {
  const auto echoes = [](const Echoes& beams) {
    std::string out = u32(beams.size());
    for (const std::vector<double>& beam : beams) out += u32(beam.size()) + floats(beam);
    return out;
  };
  const double last = n.angle_min + n.angle_increment * (static_cast<double>(ranges.size()) - 1);
  return header(seconds, nanoseconds) +
         floats({n.angle_min, last, n.angle_increment, n.time_increment, 0.01, n.range_min, n.range_max}) +
         echoes(ranges) + echoes(intensities);
}
struct CloudField {
  std::string name;
  std::uint32_t offset = 0;
  int type = 7;
};
inline std::string cloud(std::uint32_t seconds, std::uint32_t nanoseconds, const std::vector<CloudField>& fields,
                         std::uint32_t point_step, const std::string& data, bool big_endian = false) {
  std::string out = header(seconds, nanoseconds) + u32(1) + u32(data.size() / point_step) + u32(fields.size());
  for (const CloudField& f : fields) out += counted(f.name) + u32(f.offset) + u8(f.type) + u32(1);
  return out + u8(big_endian ? 1 : 0) + u32(point_step) + u32(data.size()) + counted(data) + u8(1);
}

}  // namespace rayfield::formats::bytes
