#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/formats/bag_bytes.h"

/// LAS files byte by byte, from the tables of the ASPRS specifications and independent of the library's writer.
namespace rayfield::formats::bytes {

inline std::string u16(int value) { return le(static_cast<std::uint16_t>(value)); }
inline std::string u64(std::uint64_t value) { return le(value); }
/// A field of fixed length, filled up with zeros.
inline std::string fixed(std::string text, std::size_t length) {
  text.resize(length, '\0');
  return text;
}

struct LasTestPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double time_s = 0;
  int intensity = 100, return_number = 1, returns = 1, classification = 2;
  bool synthetic = false, withheld = false;
};

/// What a test varies about a file.
struct LasSpec {
  int minor = 4, format = 6, encoding = 1;
  double scale = 0.001;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::vector<std::string> records;  ///< of variable length, with their heads
  std::string extended;              ///< extended records behind the points, with their heads
  int extended_count = 0;
  int extra_bytes = 0;  ///< of each point
  std::vector<LasTestPoint> points;
};

inline std::string las_record(const std::string& user, int id, const std::string& payload) {
  return u16(0) + fixed(user, 16) + u16(id) + u16(static_cast<int>(payload.size())) + fixed("", 32) + payload;
}
inline std::string extended_las_record(const std::string& user, int id, const std::string& payload) {
  return u16(0) + fixed(user, 16) + u16(id) + u64(payload.size()) + fixed("", 32) + payload;
}
/// A GeoKeyDirectoryTag: entries of key, location, count, value.
inline std::string geokeys(const std::vector<std::vector<int>>& entries) {
  std::string payload = u16(1) + u16(1) + u16(0) + u16(static_cast<int>(entries.size()));
  for (const std::vector<int>& entry : entries)
    for (const int number : entry) payload += u16(number);
  return las_record("LASF_Projection", 34735, payload);
}

inline std::string las_point(const LasSpec& spec, const LasTestPoint& p) {
  static constexpr int kBytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  std::string out;
  for (int k = 0; k < 3; ++k)
    out += le(static_cast<std::int32_t>(std::lround((p.position[k] - spec.offset[k]) / spec.scale)));
  out += u16(p.intensity);
  if (spec.format >= 6) {
    out += u8(p.return_number | (p.returns << 4)) + u8((p.synthetic ? 1 : 0) | (p.withheld ? 4 : 0));
    out += u8(p.classification) + u8(0) + u16(0) + u16(0) + f64(p.time_s);
  } else {
    out += u8(p.return_number | (p.returns << 3));
    out += u8(p.classification | (p.synthetic ? 0x20 : 0) | (p.withheld ? 0x80 : 0)) + u8(0) + u8(0) + u16(0);
    if (spec.format != 0 && spec.format != 2) out += f64(p.time_s);
  }
  return fixed(out, static_cast<std::size_t>(kBytes[spec.format] + spec.extra_bytes));
}

inline std::string las_bytes(const LasSpec& spec) {
  static constexpr int kHeader[] = {0, 0, 227, 235, 375};
  std::string records, points;
  for (const std::string& record : spec.records) records += record;
  for (const LasTestPoint& point : spec.points) points += las_point(spec, point);
  const std::size_t header_bytes = static_cast<std::size_t>(kHeader[spec.minor]);
  const std::size_t point_bytes = las_point(spec, {}).size(), begin = header_bytes + records.size();
  const std::size_t count = spec.points.size(), old_count = spec.format < 6 ? count : 0;
  std::string out = "LASF" + u16(0) + u16(spec.encoding) + fixed("", 16) + u8(1) + u8(spec.minor);
  out += fixed("a test", 32) + fixed("by hand", 32) + u16(182) + u16(2021) + u16(kHeader[spec.minor]);
  out += u32(begin) + u32(spec.records.size()) + u8(spec.format) + u16(static_cast<int>(point_bytes));
  out += u32(old_count) + u32(old_count) + fixed("", 16);  // in all, and by return
  for (int k = 0; k < 3; ++k) out += f64(spec.scale);
  for (int k = 0; k < 3; ++k) out += f64(spec.offset[k]);
  out += doubles({0, 0, 0, 0, 0, 0});  // the box is not looked at
  if (spec.minor >= 3) out += u64(0);
  if (spec.minor >= 4) {
    out +=
        u64(spec.extended_count > 0 ? begin + points.size() : 0) + u32(static_cast<std::uint64_t>(spec.extended_count));
    out += u64(count) + u64(count) + fixed("", 14 * 8);
  }
  return out + records + points + spec.extended;
}

/// `text` with some of its bytes replaced.
inline std::string patched(std::string text, std::size_t at, const std::string& by) {
  return text.replace(at, by.size(), by);
}

}  // namespace rayfield::formats::bytes
