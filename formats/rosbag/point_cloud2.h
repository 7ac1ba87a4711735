#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/number_type.h"
#include "formats/rosbag/ros_header.h"

namespace rayfield::formats {

/// A column of a point cloud.
struct PointFieldView {
  std::string_view name;
  std::uint32_t offset = 0;
  NumberType type = NumberType::f32;
  std::uint32_t count = 0;
  double value(const std::byte* point) const { return load_number(point + offset, type); }
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
  std::string field_names() const;  ///< with spaces between, for messages
};
/// Checks also that every point, with every field, lies within the data.
std::optional<PointCloud2View> decode_point_cloud2(std::span<const std::byte> message);

}  // namespace rayfield::formats
