#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/byte_cursor.h"
#include "rayfield/core/sensor_log.h"

/// The sensor_msgs that rayfield reads and writes, in ROS 1 serialisation: fields in order, little-endian, no padding,
/// strings and arrays with a u32 count in front. Decoders give nothing where a message is not exactly as long as its
/// own counts say.
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
/// The definition of a type that rayfield reads; null for others.
const RosDefinition* find_ros_definition(std::string_view type);

/// std_msgs/Header, with which all of these messages begin.
struct RosHeader {
  std::uint32_t seq = 0;
  std::int64_t stamp_ns = 0;
  std::string_view frame_id;
};
RosHeader take_ros_header(ByteCursor& cursor);
/// The stamp alone; nothing where the message is shorter than a header.
std::optional<std::int64_t> peek_ros_stamp(std::span<const std::byte> message);

/// Unix time in seconds from nanoseconds, exact to the spacing of doubles (0.24 µs in this century).
inline double seconds_from_ns(std::int64_t time_ns) {
  return static_cast<double>(time_ns / 1'000'000'000) + static_cast<double>(time_ns % 1'000'000'000) * 1e-9;
}
/// The nearest nanosecond; seconds_from_ns() of it gives the same double back. -1 for what ROS cannot express: NaN and
/// times outside 0 … 2^32 s.
std::int64_t ns_from_seconds(double time_s);

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

struct LaserScanView {
  RosHeader header;
  float angle_min = 0, angle_max = 0, angle_increment = 0, time_increment = 0, scan_time = 0;
  float range_min = 0, range_max = 0;
  std::span<const std::byte> ranges, intensities;  ///< float32[]
  std::size_t beams() const { return ranges.size() / sizeof(float); }
};
std::optional<LaserScanView> decode_laser_scan(std::span<const std::byte> message);

/// sensor_msgs/PointField datatypes.
enum class PointType : std::uint8_t { i8 = 1, u8, i16, u16, i32, u32, f32, f64 };
std::size_t point_type_bytes(PointType type);  ///< 0 for an unknown number

struct PointFieldView {
  std::string_view name;
  std::uint32_t offset = 0;
  PointType type = PointType::f32;
  std::uint32_t count = 0;
};

struct PointCloud2View {
  RosHeader header;
  std::uint32_t height = 0, width = 0;
  std::vector<PointFieldView> fields;
  bool big_endian = false;
  std::uint32_t point_step = 0, row_step = 0;
  std::span<const std::byte> data;
  std::size_t points() const { return std::size_t{height} * width; }
  const PointFieldView* find(std::string_view name) const;
};
/// Checks also that every point, with every field, lies within the data.
std::optional<PointCloud2View> decode_point_cloud2(std::span<const std::byte> message);

void encode_imu(const ImuSample& sample, std::uint32_t seq, std::string_view frame, ByteBuilder& out);
void encode_nav_sat_fix(const GpsFix& fix, std::uint32_t seq, std::string_view frame, ByteBuilder& out);
void encode_joint_state(const SpinnerAngle& angle, double rate_rad_s, std::uint32_t seq, std::string_view frame,
                        std::string_view joint, ByteBuilder& out);
void encode_ros_header(std::uint32_t seq, double stamp_s, std::string_view frame, ByteBuilder& out);

}  // namespace rayfield::formats
