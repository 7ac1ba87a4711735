#pragma once

/// las: LAS files as input: header, records of variable length, points, and the clocks of their times.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "rayfield/core/result.h"

namespace rayfield::formats {

inline constexpr const char* kLasWhat = "cannot read LAS cloud";

/// What a LAS header says (ASPRS LAS 1.2, 1.3, 1.4 R15, "Public Header Block").
struct LasHeader {
  int minor_version = 0;  ///< 1.2 to 1.4
  std::uint16_t global_encoding = 0;
  std::uint16_t header_bytes = 0;   ///< records of variable length begin here
  std::uint32_t points_offset = 0;  ///< the first point begins here
  std::uint32_t record_count = 0;   ///< of variable length
  std::uint8_t point_format = 0;
  std::uint16_t point_bytes = 0;  ///< extra bytes included
  std::uint64_t point_count = 0;
  std::uint64_t waveform_offset = 0;  ///< of waveforms inside the file; 0: none
  std::uint64_t extended_offset = 0;  ///< extended records of variable length begin here
  std::uint32_t extended_count = 0;
  Eigen::Array3d scale = Eigen::Array3d::Ones(), offset = Eigen::Array3d::Zero();  ///< m

  /// Bit 0 of the global encoding: times are adjusted standard GPS time, else seconds of the GPS week.
  bool says_adjusted_gps_time() const { return (global_encoding & 1U) != 0; }
  /// Bit 4: the CRS is WKT, else GeoTIFF keys.
  bool says_wkt() const { return (global_encoding & 16U) != 0; }
  /// Formats 6 and above: four bits of return number, eight of class.
  bool has_wide_points() const { return point_format >= 6; }
  /// Of the time of a point in its record.
  std::size_t time_offset() const { return has_wide_points() ? 22 : 20; }
  /// Where the points end, by the header.
  std::uint64_t points_end() const { return points_offset + point_count * point_bytes; }
};

/// Longest header of the versions that are read.
inline constexpr std::size_t kLasHeaderBytes = 375;

/// Parses the header at the beginning of `bytes`: the first kLasHeaderBytes of the file, or all of a shorter one.
/// Errors: bad_input with the offset in `where`: not a LAS file, a version or point format that is not read (1.0, 1.1,
/// points without time, compressed points), lengths, scales or counts that contradict each other.
Result<LasHeader> parse_las_header(std::span<const std::byte> bytes);

/// True for bytes that begin like a LAS file.
bool begins_like_las(std::span<const std::byte> bytes);

}  // namespace rayfield::formats
