#include "formats/rosbag/point_cloud2.h"

#include <algorithm>

namespace rayfield::formats {

const PointFieldView* PointCloud2View::find(std::string_view name) const {
  for (const PointFieldView& field : fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

std::string PointCloud2View::field_names() const {
  std::string names;
  for (const PointFieldView& field : fields) {
    if (!names.empty()) names += ' ';
    names += field.name;
  }
  return names;
}

/// Reads the fields' descriptions and then checks once what the loops over points rely on: rows and fields lie inside.
std::optional<PointCloud2View> decode_point_cloud2(std::span<const std::byte> message) {
  // No driver has more fields than this; the count in the message cannot ask for more.
  constexpr std::size_t kMaxFields = 256;
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
    field.type = static_cast<NumberType>(cursor.get<std::uint8_t>());
    field.count = cursor.get<std::uint32_t>();
    cloud.fields.push_back(field);
  }
  cloud.big_endian = cursor.get<std::uint8_t>() != 0;
  cloud.point_step = cursor.get<std::uint32_t>();
  cloud.row_step = cursor.get<std::uint32_t>();
  cloud.data = cursor.take_counted();
  cursor.get<std::uint8_t>();  // is_dense; points are checked one by one anyway
  if (cursor.failed() || cursor.remaining() != 0) return std::nullopt;
  if (cloud.points() == 0) cloud.height = cloud.width = 0;  // four billion empty rows are no work
  // Products of two u32 fit into u64, so nothing here can overflow.
  const std::uint64_t row_bytes = std::uint64_t{cloud.width} * cloud.point_step;
  if (cloud.height == 1) cloud.row_step = static_cast<std::uint32_t>(std::min<std::uint64_t>(row_bytes, UINT32_MAX));
  if (cloud.points() > 0 && (cloud.point_step == 0 || cloud.row_step < row_bytes)) return std::nullopt;
  if (cloud.data.size() < std::uint64_t{cloud.height} * cloud.row_step) return std::nullopt;
  for (const PointFieldView& field : cloud.fields) {
    const std::size_t bytes = number_bytes(field.type);
    if (bytes == 0 || std::uint64_t{field.offset} + bytes > cloud.point_step) return std::nullopt;
  }
  return cloud;
}

}  // namespace rayfield::formats
