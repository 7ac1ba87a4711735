#include "formats/las/las_crs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "rayfield/core/byte_cursor.h"
#include "rayfield/core/map_frame.h"

namespace rayfield::formats {
namespace {

constexpr std::size_t kHeadBytes = 54, kExtendedHeadBytes = 60;
constexpr std::uint64_t kLongestRecord = std::uint64_t{1} << 20;  // of a CRS
constexpr std::uint64_t kMostRecords = 100000;
constexpr std::string_view kUser = "LASF_Projection";
constexpr std::uint16_t kWktRecord = 2112, kKeysRecord = 34735;

// What the records say of the CRS; the first of each kind counts.
struct Records {
  std::optional<std::string> wkt, keys;
};

struct RecordHead {
  std::string_view user;
  std::uint16_t id = 0;
  std::uint64_t bytes = 0;  // behind the head
};

RecordHead parse_head(std::span<const std::byte> bytes, bool extended) {
  RecordHead head;
  const char* user = reinterpret_cast<const char*>(&bytes[2]);
  head.user = {user, ::strnlen(user, 16)};
  head.id = load<std::uint16_t>(&bytes[18]);
  head.bytes = extended ? load<std::uint64_t>(&bytes[20]) : load<std::uint16_t>(&bytes[20]);
  return head;
}

// `count` records between two offsets of the file.
Result<void> walk(FileWindow& window, std::uint64_t at, std::uint64_t end, std::uint64_t count, bool extended,
                  Records& found) {
  const std::size_t head_bytes = extended ? kExtendedHeadBytes : kHeadBytes;
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto bad = [&]() {
      return fail(ErrorCode::bad_input, kLasWhat, fmt::format("{} at byte {}", window.file().path(), at),
                  fmt::format("record {} of {} of variable length reaches {}", i + 1, count,
                              extended ? "out of the file" : "into the points"),
                  "export the cloud again");
    };
    if (i >= kMostRecords || at > end || end - at < head_bytes) return bad();
    RAYFIELD_ASSIGN(std::span<const std::byte> bytes, window.view(at, head_bytes));
    if (bytes.size() < head_bytes) return bad();
    const RecordHead head = parse_head(bytes, extended);
    if (head.bytes > end - at - head_bytes) return bad();
    std::optional<std::string>* place = nullptr;
    if (head.user == kUser && head.id == kWktRecord) place = &found.wkt;
    if (head.user == kUser && head.id == kKeysRecord) place = &found.keys;
    const std::uint64_t payload = head.bytes;
    if (place != nullptr && !*place && payload <= kLongestRecord) {
      RAYFIELD_ASSIGN(bytes, window.view(at + head_bytes, static_cast<std::size_t>(payload)));
      if (bytes.size() < payload) return bad();
      place->emplace(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    at += head_bytes + payload;
  }
  return {};
}

// PROJCS["GDA2020 / MGA zone 54", …: the name between the first quotes, behind a keyword. Empty where it is no WKT.
std::string name_in(const std::string& wkt) {
  const std::size_t keyword = wkt.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_");
  if (keyword == 0 || keyword == std::string::npos || wkt[keyword] != '[') return {};
  const std::size_t begin = wkt.find('"', keyword), end = begin == std::string::npos ? begin : wkt.find('"', begin + 1);
  return end == std::string::npos ? std::string() : wkt.substr(begin + 1, std::min<std::size_t>(end - begin - 1, 80));
}

LasCrs crs_of_wkt(std::string wkt) {
  wkt.resize(::strnlen(wkt.data(), wkt.size()));
  const std::size_t begin = wkt.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return {};
  wkt.erase(0, begin);
  LasCrs crs;
  if (name_in(wkt).empty()) {
    crs.text = crs.name = "a CRS whose WKT cannot be read";
    return crs;
  }
  const auto known = lookup_projected_crs(wkt);
  const bool has_code = known && known->code.size() <= 64;
  crs.text = has_code ? known->code : wkt;
  crs.name = has_code ? known->code : name_in(wkt);
  return crs;
}

LasCrs crs_of_keys(const std::string& keys) {
  LasCrs crs;
  crs.text = crs_of_geokeys(std::as_bytes(std::span(keys)));
  if (crs.text)
    crs.name = *crs.text;
  else
    crs.note = "its GeoTIFF keys name no CRS by code: taken to be in the store's";
  return crs;
}

}  // namespace

std::optional<std::string> crs_of_geokeys(std::span<const std::byte> keys) {
  constexpr std::uint16_t kModel = 1024, kGeographic = 2048, kProjected = 3072, kGeographicModel = 2;
  constexpr std::uint16_t kLeastCode = 1024, kUserDefined = 32767;
  constexpr std::size_t kEntry = 4;
  const std::size_t numbers = keys.size() / sizeof(std::uint16_t);
  const auto number = [&](std::size_t i) { return load<std::uint16_t>(&keys[i * sizeof(std::uint16_t)]); };
  if (numbers < kEntry || number(0) != 1) return std::nullopt;
  std::uint16_t model = 0, geographic = 0, projected = 0;
  const std::size_t entries = std::min<std::size_t>(number(3), numbers / kEntry - 1);
  for (std::size_t i = 1; i <= entries; ++i) {
    if (number(kEntry * i + 1) != 0) continue;  // a value that stands elsewhere is no code
    const std::uint16_t key = number(kEntry * i), value = number(kEntry * i + 3);
    if (key == kModel) model = value;
    if (key == kGeographic) geographic = value;
    if (key == kProjected) projected = value;
  }
  const std::uint16_t code = model == kGeographicModel ? geographic : projected;
  if (code < kLeastCode || code >= kUserDefined) return std::nullopt;
  return fmt::format("EPSG:{}", code);
}

Result<LasCrs> read_las_crs(FileWindow& window, const LasHeader& header) {
  Records found;
  const std::uint64_t size = window.file().size();
  RAYFIELD_CHECK(walk(window, header.header_bytes, std::min<std::uint64_t>(header.points_offset, size),
                      header.record_count, false, found));
  // Of a truncated file the points are what counts.
  const bool has_extended = header.extended_count > 0 && header.extended_offset >= header.points_end() &&
                            header.extended_offset <= size && header.points_end() <= size;
  if (has_extended) RAYFIELD_CHECK(walk(window, header.extended_offset, size, header.extended_count, true, found));
  const bool takes_wkt = found.wkt && (header.says_wkt() || !found.keys);
  if (takes_wkt) {
    LasCrs crs = crs_of_wkt(std::move(*found.wkt));
    if (crs.text || !found.keys) return crs;
  }
  return found.keys ? crs_of_keys(*found.keys) : LasCrs();
}

}  // namespace rayfield::formats
