#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "rayfield/core/byte_cursor.h"

namespace rayfield::formats {

/// Types of the numbers in a file whose columns a header describes (PLY, sensor_msgs/PointCloud2). The values are those
/// of sensor_msgs/PointField.
enum class NumberType : std::uint8_t { i8 = 1, u8, i16, u16, i32, u32, f32, f64 };

/// 0 for a value that is not one of the types.
std::size_t number_bytes(NumberType type);

/// A number of any type as a double, exactly; NaN for a value that is not one of the types. The caller has checked that
/// it lies inside.
inline double load_number(const std::byte* from, NumberType type) {
  switch (type) {
    case NumberType::i8:
      return static_cast<double>(load<std::int8_t>(from));
    case NumberType::u8:
      return static_cast<double>(load<std::uint8_t>(from));
    case NumberType::i16:
      return static_cast<double>(load<std::int16_t>(from));
    case NumberType::u16:
      return static_cast<double>(load<std::uint16_t>(from));
    case NumberType::i32:
      return static_cast<double>(load<std::int32_t>(from));
    case NumberType::u32:
      return static_cast<double>(load<std::uint32_t>(from));
    case NumberType::f32:
      return static_cast<double>(load<float>(from));
    case NumberType::f64:
      return load<double>(from);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace rayfield::formats
