#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "rayfield/core/byte_cursor.h"

namespace rayfield::formats {

/// std_msgs/Header, with which all of these messages begin.
struct RosHeader {
  std::uint32_t seq = 0;
  std::int64_t stamp_ns = 0;
  std::string_view frame_id;
};
RosHeader take_ros_header(ByteCursor& cursor);
void put_ros_header(std::uint32_t seq, double stamp_s, std::string_view frame, ByteBuilder& out);
/// The stamp alone; nothing where the message is shorter than a header.
std::optional<std::int64_t> peek_ros_stamp(std::span<const std::byte> message);

/// Unix time in seconds from nanoseconds, exact to the spacing of doubles (0.24 µs in this century).
inline double seconds_from_ns(std::int64_t time_ns) {
  const std::int64_t whole_s = time_ns / 1'000'000'000, rest_ns = time_ns % 1'000'000'000;
  return static_cast<double>(whole_s) + static_cast<double>(rest_ns) * 1e-9;
}
/// The nearest nanosecond; seconds_from_ns() of it gives the same double back. -1 for what ROS cannot express: NaN and
/// times outside 0 … 2^32 s.
std::int64_t ns_from_seconds(double time_s);

}  // namespace rayfield::formats
