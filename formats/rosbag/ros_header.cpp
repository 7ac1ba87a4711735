#include "formats/rosbag/ros_header.h"

#include <cmath>

namespace rayfield::formats {

RosHeader take_ros_header(ByteCursor& cursor) {
  RosHeader header;
  header.seq = cursor.get<std::uint32_t>();
  const std::int64_t seconds = cursor.get<std::uint32_t>();
  const std::int64_t nanoseconds = cursor.get<std::uint32_t>();
  header.stamp_ns = seconds * 1'000'000'000 + nanoseconds;
  header.frame_id = cursor.text();
  return header;
}

std::optional<std::int64_t> peek_ros_stamp(std::span<const std::byte> message) {
  ByteCursor cursor(message);
  const RosHeader header = take_ros_header(cursor);
  if (cursor.failed()) return std::nullopt;
  return header.stamp_ns;
}

std::int64_t ns_from_seconds(double time_s) {
  if (!(time_s >= 0 && time_s < 4294967296.0)) return -1;
  const double whole = std::floor(time_s);
  return static_cast<std::int64_t>(whole) * 1'000'000'000 + std::llround((time_s - whole) * 1e9);
}

void put_ros_header(std::uint32_t seq, double stamp_s, std::string_view frame, ByteBuilder& out) {
  const std::int64_t stamp_ns = ns_from_seconds(stamp_s);
  out.put(seq);
  out.put(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000));
  out.put(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
  out.text(frame);
}

}  // namespace rayfield::formats
