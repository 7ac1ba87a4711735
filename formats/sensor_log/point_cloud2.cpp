#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "formats/rosbag/ros_messages.h"
#include "formats/sensor_log/lidar_decoder.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot read lidar";
/// More fields than this no driver has; the count in the message cannot ask for more.
constexpr std::size_t kMaxFields = 256;

/// Names of the field with the time of each point: Velodyne `time`, Ouster `t`, Hesai and RoboSense `timestamp`,
/// Livox `offset_time` and `timestamp`, and what converters make of them.
constexpr std::array<std::string_view, 8> kTimeNames = {"time",        "t",          "timestamp",  "offset_time",
                                                        "time_offset", "time_stamp", "timeoffset", "timestamp_offset"};

bool is_integer(PointType type) { return type != PointType::f32 && type != PointType::f64; }

}  // namespace

std::size_t point_type_bytes(PointType type) {
  switch (type) {
    case PointType::i8:
    case PointType::u8:
      return 1;
    case PointType::i16:
    case PointType::u16:
      return 2;
    case PointType::i32:
    case PointType::u32:
    case PointType::f32:
      return 4;
    case PointType::f64:
      return 8;
  }
  return 0;
}

const PointFieldView* PointCloud2View::find(std::string_view name) const {
  for (const PointFieldView& field : fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

std::optional<PointCloud2View> decode_point_cloud2(std::span<const std::byte> message) {
  ByteCursor cursor(message);
  PointCloud2View cloud;
  cloud.header = take_ros_header(cursor);
  cloud.height = cursor.get<std::uint32_t>();
  cloud.width = cursor.get<std::uint32_t>();
  const std::size_t field_count = cursor.get<std::uint32_t>();
  if (field_count > kMaxFields) return std::nullopt;
  for (std::size_t i = 0; i < field_count; ++i) {
    PointFieldView field;
    field.name = cursor.text();
    field.offset = cursor.get<std::uint32_t>();
    field.type = static_cast<PointType>(cursor.get<std::uint8_t>());
    field.count = cursor.get<std::uint32_t>();
    cloud.fields.push_back(field);
  }
  cloud.big_endian = cursor.get<std::uint8_t>() != 0;
  cloud.point_step = cursor.get<std::uint32_t>();
  cloud.row_step = cursor.get<std::uint32_t>();
  cloud.data = cursor.take_counted();
  cursor.get<std::uint8_t>();  // is_dense; points are checked one by one anyway
  if (cursor.failed() || cursor.remaining() != 0) return std::nullopt;
  // Products of two u32 fit into u64, so nothing here can overflow.
  const std::uint64_t row_bytes = std::uint64_t{cloud.width} * cloud.point_step;
  if (cloud.height == 1) cloud.row_step = static_cast<std::uint32_t>(std::min<std::uint64_t>(row_bytes, UINT32_MAX));
  if (cloud.points() > 0 && (cloud.point_step == 0 || cloud.row_step < row_bytes)) return std::nullopt;
  if (cloud.data.size() < std::uint64_t{cloud.height} * cloud.row_step) return std::nullopt;
  for (const PointFieldView& field : cloud.fields) {
    const std::size_t bytes = point_type_bytes(field.type);
    if (bytes == 0 || std::uint64_t{field.offset} + bytes > cloud.point_step) return std::nullopt;
  }
  return cloud;
}

Result<PointTime> PointTime::find(const PointCloud2View& cloud, std::int64_t stamp_ns) {
  PointTime time;
  const PointFieldView* field = nullptr;
  for (const std::string_view name : kTimeNames) {
    if (field == nullptr) field = cloud.find(name);
  }
  // A time of 8 or 16 bits cannot be one.
  if (field == nullptr || point_type_bytes(field->type) < 4) {
    std::string names;
    for (const PointFieldView& each : cloud.fields) {
      if (!names.empty()) names += ' ';
      names += each.name;
    }
    return fail(ErrorCode::bad_input, kWhat, {}, "the point clouds carry no time per point (fields: " + names + ")",
                "switch on time stamps per point in the lidar's driver and record again");
  }
  time.field_ = *field;
  if (is_integer(field->type)) {
    time.factor_ = 1e-9;
    return time;
  }
  // The size of the first usable value tells seconds of a sweep from seconds, microseconds or nanoseconds since 1970.
  // Whole seconds are subtracted first, which is exact, so that the small difference keeps its digits.
  const double whole_s = static_cast<double>(stamp_ns / 1'000'000'000);
  const auto since_1970 = [&](double per_second) {
    time.base_ = whole_s * per_second, time.factor_ = 1 / per_second;
    time.rest_s_ = static_cast<double>(stamp_ns % 1'000'000'000) * 1e-9;
  };
  for (std::size_t i = 0; i < cloud.points(); ++i) {
    const std::size_t row = i / cloud.width, column = i % cloud.width;
    const std::byte* point = cloud.data.data() + row * cloud.row_step + column * cloud.point_step;
    const double value = point_value(point, *field);
    if (!std::isfinite(value) || value == 0.0) continue;
    if (value > 1e17)
      since_1970(1e9);
    else if (value > 1e14)
      since_1970(1e6);
    else if (value > 1e8)
      since_1970(1);
    else if (std::abs(value) > 1e3)
      time.factor_ = 1e-9;
    break;
  }
  return time;
}

}  // namespace rayfield::formats
