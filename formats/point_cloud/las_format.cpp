#include "formats/point_cloud/las_format.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>

#include "formats/gis/gdal_session.h"
#include "formats/las/gps_time.h"
#include "rayfield/core/date.h"

/// LAS 1.4 (ASPRS, revision R15, 2019). A file is:
///   375 B   header
///   54 B    head of a variable length record, then WKT of the CRS (LASF_Projection, 2112), ending in a zero byte
///   54 B    head of another, then 192 B that describe the extra bytes of a point (LASF_Spec, 4)
///   40 B    per point: point data record format 7, then float density
namespace rayfield::formats {
namespace {

constexpr std::uint16_t kHeaderBytes = 375, kVlrHead = 54, kExtraBytes = 192;
constexpr std::uint8_t kPointFormat = 7;
constexpr std::uint16_t kPointBytes = 36 + sizeof(float);
constexpr std::uint16_t kAdjustedGpsTime = 1, kWkt = 16;  // bits of the global encoding
constexpr double kScale_m = 1e-4;                         // as the store keeps coordinates
constexpr std::uint8_t kFloat = 9;                        // type of an extra byte

/// Bytes in the order in which they are appended.
class Bytes {
 public:
  template <class T>
  Bytes& number(T value) {
    append_number(bytes_, value);
    return *this;
  }
  /// A field of fixed length, filled up with zeros.
  Bytes& text(std::string_view value, std::size_t length) {
    for (std::size_t i = 0; i < length; ++i) bytes_.push_back(i < value.size() ? std::byte(value[i]) : std::byte{0});
    return *this;
  }
  Bytes& zeros(std::size_t length) { return text({}, length); }
  std::string str() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }

 private:
  std::vector<std::byte> bytes_;
};

std::string variable_length_record(std::string_view user, std::uint16_t record, std::string_view description,
                                   const std::string& payload) {
  Bytes bytes;
  bytes.number(std::uint16_t{0}).text(user, 16).number(record);
  bytes.number(static_cast<std::uint16_t>(payload.size())).text(description, 32);
  return bytes.str() + payload;
}

std::string density_record() {
  Bytes bytes;
  bytes.zeros(2).number(kFloat).number(std::uint8_t{0}).text("density", 32).zeros(4);
  bytes.zeros(5 * 24);  // no data, least, greatest, scale, offset: none is used
  bytes.text("m2/m3 of the voxel, NaN unknown", 32);
  return variable_length_record("LASF_Spec", 4, "density of the hit's voxel", bytes.str());
}

Result<std::string> wkt_of(const std::string& crs) {
  const GdalSession session;
  RAYFIELD_ASSIGN(const OGRSpatialReference reference, parse_crs(crs, kPointCloudWhat, crs));
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT1_GDAL", nullptr};
  const bool written = reference.exportToWkt(&text, options) == OGRERR_NONE && text != nullptr;
  std::string wkt = written ? text : "";
  CPLFree(text);
  if (wkt.empty() || wkt.size() > 60000)
    return fail(ErrorCode::usage, kPointCloudWhat, crs, "the CRS cannot be written as OGC WKT",
                "give the store a CRS with an EPSG code");
  return wkt;
}

struct DayOfYear {
  std::uint16_t day, year;
};

Result<DayOfYear> day_of_year(const std::string& date) {
  RAYFIELD_ASSIGN(const std::chrono::year_month_day day, parse_calendar_day(date));
  const std::chrono::year_month_day first{day.year(), std::chrono::January, std::chrono::day(1)};
  const auto number = (std::chrono::sys_days(day) - std::chrono::sys_days(first)).count() + 1;
  return DayOfYear{static_cast<std::uint16_t>(number), static_cast<std::uint16_t>(static_cast<int>(day.year()))};
}

class Las : public PointFormat {
 public:
  Las(const PointCloudOptions& options, DayOfYear day, std::string records)
      : options_(options), day_(day), records_(std::move(records)) {}

  std::string header() const override;
  std::size_t record_bytes() const override { return kPointBytes; }
  Result<void> add(const DensityPoints& points, std::size_t i, const Rgba& color, std::vector<std::byte>& to) override;

 private:
  double metres(std::int32_t units, int k) const { return units * kScale_m + options_.offset_m[k]; }

  PointCloudOptions options_;
  DayOfYear day_;
  std::string records_;
  std::array<std::int32_t, 3> low_{}, high_{};
};

std::string Las::header() const {
  Bytes b;
  b.text("LASF", 4).number(std::uint16_t{0}).number(static_cast<std::uint16_t>(kAdjustedGpsTime | kWkt)).zeros(16);
  b.number(std::uint8_t{1}).number(std::uint8_t{4});
  b.text("lidar drive", 32).text(options_.software, 32).number(day_.day).number(day_.year);
  b.number(kHeaderBytes).number(static_cast<std::uint32_t>(kHeaderBytes + records_.size())).number(std::uint32_t{2});
  b.number(kPointFormat).number(kPointBytes).zeros(6 * sizeof(std::uint32_t));  // counts of older versions
  for (int k = 0; k < 3; ++k) b.number(kScale_m);
  for (int k = 0; k < 3; ++k) b.number(options_.offset_m[k]);
  for (int k = 0; k < 3; ++k) b.number(metres(high_[k], k)).number(metres(low_[k], k));
  b.number(std::uint64_t{0}).number(std::uint64_t{0}).number(std::uint32_t{0});  // no waveforms, no extended records
  b.number(count).number(count).zeros(14 * sizeof(std::uint64_t));               // all are first returns
  return b.str() + records_;
}

Result<void> Las::add(const DensityPoints& points, std::size_t i, const Rgba& color, std::vector<std::byte>& to) {
  for (int k = 0; k < 3; ++k) {
    const double units = std::round((points.position[i][k] - options_.offset_m[k]) / kScale_m);
    if (!(std::abs(units) <= std::numeric_limits<std::int32_t>::max()))
      return fail(ErrorCode::bad_input, kPointCloudWhat, "", "a point lies more than 200 km from the block");
    const auto unit = static_cast<std::int32_t>(units);
    low_[k] = count == 0 ? unit : std::min(low_[k], unit), high_[k] = count == 0 ? unit : std::max(high_[k], unit);
    append_number(to, unit);
  }
  append_number(to, points.intensity[i]);
  append_number(to, std::uint8_t{0x11});  // return 1 of 1
  append_number(to, std::uint8_t{0});     // flags: none
  append_number(to, class_of(points.kind[i]));
  append_number(to, std::uint8_t{0});   // user data
  append_number(to, std::int16_t{0});   // scan angle
  append_number(to, std::uint16_t{0});  // point source
  append_number(to, adjusted_gps_time(points.time_s[i]));
  // Eight bits in sixteen are multiplied by 256 (R15, "Red, Green, Blue").
  for (const std::uint8_t channel : {color.r, color.g, color.b})
    append_number(to, static_cast<std::uint16_t>(channel * 256));
  append_number(to, points.density[i]);
  ++count;
  return {};
}

}  // namespace

Result<std::unique_ptr<PointFormat>> make_las_format(const PointCloudOptions& options) {
  RAYFIELD_ASSIGN(const DayOfYear day, day_of_year(options.date));
  RAYFIELD_ASSIGN(const std::string wkt, wkt_of(options.crs));
  const std::string records = variable_length_record("LASF_Projection", 2112, "OGC WKT", wkt + '\0') + density_record();
  return std::make_unique<Las>(options, day, records);
}

}  // namespace rayfield::formats
