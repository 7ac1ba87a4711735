#include "formats/las/las_point.h"

#include "rayfield/core/byte_cursor.h"

/// Records of points, by byte:
///   formats 1, 3, 4, 5    0 X Y Z i32 · 12 intensity u16 · 14 returns: number 3 bits, of a pulse 3 bits, … ·
///                         15 class 5 bits, synthetic, key-point, withheld · 16 scan angle, user data, source ·
///                         20 GPS time f64 · colours, waveforms
///   formats 6 to 10       0 X Y Z i32 · 12 intensity u16 · 14 returns: number 4 bits, of a pulse 4 bits ·
///                         15 synthetic, key-point, withheld, overlap, … · 16 class u8 · 17 user data, angle, source ·
///                         22 GPS time f64 · colours, waveforms
namespace rayfield::formats {

LasPoint decode_las_point(const std::byte* from, const LasHeader& header) {
  LasPoint point;
  for (int k = 0; k < 3; ++k)
    point.position[k] = static_cast<double>(load<std::int32_t>(from + 4 * k)) * header.scale[k] + header.offset[k];
  point.intensity = load<std::uint16_t>(from + 12);
  point.gps_time_s = load<double>(from + header.time_offset());
  const auto returns = load<std::uint8_t>(from + 14), flags = load<std::uint8_t>(from + 15);
  if (header.has_wide_points()) {
    point.return_number = returns & 0x0FU;
    point.synthetic = (flags & 0x01U) != 0, point.withheld = (flags & 0x04U) != 0;
    point.classification = load<std::uint8_t>(from + 16);
  } else {
    point.return_number = returns & 0x07U;
    point.classification = flags & 0x1FU;
    point.synthetic = (flags & 0x20U) != 0, point.withheld = (flags & 0x80U) != 0;
  }
  return point;
}

}  // namespace rayfield::formats
