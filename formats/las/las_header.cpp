#include "formats/las/las_header.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>

#include "rayfield/core/byte_cursor.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kMagic = "LASF";
constexpr std::array<std::uint16_t, 3> kHeaderOf = {227, 235, 375};  // bytes, of versions 1.2, 1.3 and 1.4
constexpr std::array<int, 3> kLastFormatOf = {3, 5, 10};
constexpr std::array<std::uint16_t, 11> kPointBytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
/// Scales are millimetres or finer; a coordinate of 2³¹ units of a kilometre lies nowhere.
constexpr double kCoarsestScale_m = 1000, kFarthestOffset_m = 1e9;

tl::unexpected<Error> bad(std::size_t byte, std::string_view why, std::string_view next = {}) {
  return fail(ErrorCode::bad_input, kLasWhat, fmt::format("header at byte {}", byte), why, next);
}

// Compressed points have the highest bits of the format set (LASzip).
Result<void> check_format(std::uint8_t format, int minor_version) {
  if ((format & 0xC0U) != 0 && (format & 0x3FU) < kPointBytes.size())
    return bad(104, "its points are compressed (LAZ)",
               "uncompress it first: `las2las -i in.laz -o out.las` or `pdal translate in.laz out.las`");
  if (format == 0 || format == 2)
    return bad(104, fmt::format("point format {} has no GPS time, by which the sensor's place would be found", format),
               "export the cloud in format 1, 3 or 6 with its times");
  if (format > kLastFormatOf[static_cast<std::size_t>(minor_version - 2)])
    return bad(104, fmt::format("LAS 1.{} has no point format {}", minor_version, format), "export the cloud again");
  return {};
}

Result<void> check_scale(const LasHeader& header) {
  for (int k = 0; k < 3; ++k) {
    if (!(header.scale[k] > 0 && header.scale[k] <= kCoarsestScale_m))
      return bad(131 + 8 * static_cast<std::size_t>(k), fmt::format("the scale of {} is {}", "xyz"[k], header.scale[k]),
                 "scales are metres per unit, such as 0.001; export the cloud again");
    if (!(std::abs(header.offset[k]) <= kFarthestOffset_m))
      return bad(155 + 8 * static_cast<std::size_t>(k),
                 fmt::format("the offset of {} is {}", "xyz"[k], header.offset[k]), "export the cloud again");
  }
  return {};
}

// Version 1.4 has a count of 64 bits beside the old one, which is zero where it does not fit, or equal.
Result<std::uint64_t> count_of(std::span<const std::byte> bytes, int minor_version) {
  const std::uint64_t old_count = load<std::uint32_t>(&bytes[107]);
  if (minor_version < 4) return old_count;
  const auto count = load<std::uint64_t>(&bytes[247]);
  if (count == 0) return old_count;
  if (old_count != 0 && old_count != count)
    return bad(247,
               fmt::format("the header announces {} points, and {} in its field of older versions", count, old_count),
               "export the cloud again");
  return count;
}

}  // namespace

bool begins_like_las(std::span<const std::byte> bytes) {
  return bytes.size() >= kMagic.size() && std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) == 0;
}

Result<LasHeader> parse_las_header(std::span<const std::byte> bytes) {
  if (!begins_like_las(bytes))
    return fail(ErrorCode::bad_input, kLasWhat, {}, "not a LAS file: it does not begin with 'LASF'",
                "give a cloud in LAS 1.2 to 1.4");
  constexpr std::string_view kWhole = "get the whole file";
  if (bytes.size() < kHeaderOf[0]) return bad(bytes.size(), "the file ends in its header", kWhole);
  LasHeader header;
  const int major = load<std::uint8_t>(&bytes[24]);
  header.minor_version = load<std::uint8_t>(&bytes[25]);
  if (major != 1 || header.minor_version < 2 || header.minor_version > 4)
    return bad(24, fmt::format("LAS {}.{} is not read", major, header.minor_version), "write it as LAS 1.2 to 1.4");
  const std::uint16_t least = kHeaderOf[static_cast<std::size_t>(header.minor_version - 2)];
  header.header_bytes = load<std::uint16_t>(&bytes[94]);
  if (header.header_bytes < least)
    return bad(
        94,
        fmt::format("a header of {} bytes; that of LAS 1.{} has {}", header.header_bytes, header.minor_version, least),
        "export the cloud again");
  if (bytes.size() < least) return bad(bytes.size(), "the file ends in its header", kWhole);
  header.global_encoding = load<std::uint16_t>(&bytes[6]);
  header.points_offset = load<std::uint32_t>(&bytes[96]);
  if (header.points_offset < header.header_bytes)
    return bad(96, fmt::format("the points begin at byte {}, in the header", header.points_offset),
               "export the cloud again");
  header.record_count = load<std::uint32_t>(&bytes[100]);
  header.point_format = load<std::uint8_t>(&bytes[104]);
  header.point_bytes = load<std::uint16_t>(&bytes[105]);
  RAYFIELD_CHECK(check_format(header.point_format, header.minor_version));
  if (header.point_bytes < kPointBytes[header.point_format])
    return bad(105,
               fmt::format("points of {} bytes; those of format {} have {}", header.point_bytes, header.point_format,
                           kPointBytes[header.point_format]),
               "export the cloud again");
  RAYFIELD_ASSIGN(header.point_count, count_of(bytes, header.minor_version));
  for (int k = 0; k < 3; ++k) {
    header.scale[k] = load<double>(&bytes[131 + 8 * static_cast<std::size_t>(k)]);
    header.offset[k] = load<double>(&bytes[155 + 8 * static_cast<std::size_t>(k)]);
  }
  RAYFIELD_CHECK(check_scale(header));
  if (header.minor_version >= 3) header.waveform_offset = load<std::uint64_t>(&bytes[227]);
  if (header.minor_version >= 4) {
    header.extended_offset = load<std::uint64_t>(&bytes[235]);
    header.extended_count = load<std::uint32_t>(&bytes[243]);
  }
  return header;
}

}  // namespace rayfield::formats
