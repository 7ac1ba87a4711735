#include "formats/sensor_log/point_time.h"

#include <array>
#include <cmath>
#include <string_view>

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot read lidar";

/// Names of the field with the time of each point: Velodyne `time`, Ouster `t`, Hesai and RoboSense `timestamp`,
/// Livox `offset_time` and `timestamp`, and what converters make of them.
constexpr std::array<std::string_view, 8> kTimeNames = {"time",        "t",          "timestamp",  "offset_time",
                                                        "time_offset", "time_stamp", "timeoffset", "timestamp_offset"};

}  // namespace

/// Drivers agree neither on the field's name nor on its unit: integers are nanoseconds after the stamp, and the unit of
/// floating-point times follows from their size.
Result<PointTime> PointTime::find(const PointCloud2View& cloud, std::int64_t stamp_ns) {
  PointTime time;
  const PointFieldView* field = nullptr;
  for (const std::string_view name : kTimeNames) {
    if (field == nullptr) field = cloud.find(name);
  }
  // A time of 8 or 16 bits cannot be one.
  if (field == nullptr || number_bytes(field->type) < 4) {
    return fail(ErrorCode::bad_input, kWhat, {},
                "the point clouds carry no time per point (fields: " + cloud.field_names() + ")",
                "switch on time stamps per point in the lidar's driver and record again");
  }
  time.field_ = *field;
  if (field->type != NumberType::f32 && field->type != NumberType::f64) {
    time.factor_ = 1e-9;
    return time;
  }
  // The magnitude of the first usable value shows whether it is seconds of a sweep, or s, µs or ns since 1970.
  // Whole seconds are subtracted first, which is exact, so that the small difference keeps its digits.
  const std::int64_t whole_seconds = stamp_ns / 1'000'000'000;
  const auto whole_s = static_cast<double>(whole_seconds);
  const auto since_1970 = [&](double per_second) {
    time.base_ = whole_s * per_second, time.factor_ = 1 / per_second;
    time.rest_s_ = static_cast<double>(stamp_ns % 1'000'000'000) * 1e-9;
  };
  for (std::size_t i = 0; i < cloud.points(); ++i) {
    const std::size_t row = i / cloud.width, column = i % cloud.width;
    const std::byte* point = cloud.data.data() + row * cloud.row_step + column * cloud.point_step;
    const double value = field->value(point);
    if (!std::isfinite(value) || value == 0.0) continue;
    if (value > 1e17)
      since_1970(1e9);
    else if (value > 1e14)
      since_1970(1e6);
    else if (value > 1e8)
      since_1970(1);
    else if (std::abs(value) > 1e3)
      time.factor_ = 1e-9;
    break;
  }
  return time;
}

}  // namespace rayfield::formats
