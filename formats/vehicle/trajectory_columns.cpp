#include "formats/vehicle/trajectory_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace rayfield::formats {
namespace {

using Names = std::span<const std::string_view>;
constexpr std::array<std::string_view, 9> kTime = {"t",       "time",      "timestamp",   "time_s", "gps_time",
                                                   "gpstime", "unix_time", "gps_seconds", "seconds"};
constexpr std::array<std::string_view, 6> kEast = {"x", "tx", "easting", "east", "e", "x_m"};
constexpr std::array<std::string_view, 6> kNorth = {"y", "ty", "northing", "north", "n", "y_m"};
constexpr std::array<std::string_view, 10> kHeight = {"z",         "tz",   "height", "altitude", "alt",
                                                      "elevation", "elev", "up",     "h",        "z_m"};
constexpr std::array<std::string_view, 4> kDegrees = {"latitude", "longitude", "lat", "lon"};
constexpr std::array<std::string_view, 4> kQuaternion = {"qx", "qy", "qz", "qw"};

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

// A field without its quotes.
std::string_view unquoted(std::string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = trimmed(text.substr(1, text.size() - 2));
  return text;
}

std::vector<std::string_view> fields_of(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  line = trimmed(line);
  while (!line.empty()) {
    const std::size_t end = separator == ' ' ? line.find_first_of(" \t") : line.find(separator);
    fields.push_back(unquoted(line.substr(0, end)));
    if (end == std::string_view::npos) break;
    line.remove_prefix(end + 1);
    if (separator == ' ') line = trimmed(line);
  }
  return fields;
}

// "Easting [m]" → "easting", "GPS Time" → "gps_time".
std::string plain_name(std::string_view field) {
  std::string name;
  for (const char c : trimmed(field.substr(0, field.find_first_of("[(")))) {
    const auto letter = static_cast<unsigned char>(c);
    name += c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(letter));
  }
  name.erase(std::remove(name.begin(), name.end(), '%'), name.end());
  return name;
}

std::optional<double> number_of(std::string_view field) {
  double value = 0;
  if (field.starts_with('+')) field.remove_prefix(1);
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  const bool whole = error == std::errc() && end == field.data() + field.size() && !field.empty();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

tl::unexpected<Error> bad(const std::string& why, std::string_view next) {
  return fail(ErrorCode::bad_input, {}, {}, why, next);
}

// Index of the only column with one of the names; the number of columns where there is none.
Result<std::size_t> place_of(const std::vector<std::string>& columns, Names names) {
  const auto is_named = [names](const std::string& column) {
    return std::find(names.begin(), names.end(), column) != names.end();
  };
  const auto first = std::find_if(columns.begin(), columns.end(), is_named);
  if (first != columns.end() && std::find_if(first + 1, columns.end(), is_named) != columns.end())
    return bad(fmt::format("the header names two columns of '{}'", first->substr(0, 40)), "leave one out");
  return static_cast<std::size_t>(first - columns.begin());
}

}  // namespace

bool TrajectoryColumns::are_tum() const {
  return separator == ' ' && time == 0 && position == std::array<std::size_t, 3>{1, 2, 3} && quaternion &&
         *quaternion == std::array<std::size_t, 4>{4, 5, 6, 7};
}

Result<std::optional<TrajectoryColumns>> find_trajectory_columns(std::string_view line) {
  line = trimmed(line);
  while (line.starts_with('%') || line.starts_with('#')) line = trimmed(line.substr(1));
  TrajectoryColumns columns;
  columns.separator = ' ';
  for (const char separator : {',', ';', '\t'})
    if (columns.separator == ' ' && line.find(separator) != std::string_view::npos) columns.separator = separator;
  std::vector<std::string> names;
  for (const std::string_view field : fields_of(line, columns.separator)) names.push_back(plain_name(field));
  RAYFIELD_ASSIGN(columns.time, place_of(names, kTime));
  if (columns.time == names.size()) return std::optional<TrajectoryColumns>();
  const std::array<Names, 3> axes = {kEast, kNorth, kHeight};
  for (std::size_t k = 0; k < axes.size(); ++k) {
    RAYFIELD_ASSIGN(columns.position[k], place_of(names, axes[k]));
    if (columns.position[k] < names.size()) continue;
    if (std::find_first_of(names.begin(), names.end(), kDegrees.begin(), kDegrees.end()) != names.end())
      return bad("its places are in degrees", "write them as easting, northing and height in the cloud's CRS");
    return bad(fmt::format("the header names no column of '{}'", axes[k][2]),
               "name the columns time, x, y, z, and qx, qy, qz, qw where there are orientations");
  }
  std::array<std::size_t, 4> quaternion{};
  std::size_t found = 0;
  for (std::size_t k = 0; k < quaternion.size(); ++k) {
    RAYFIELD_ASSIGN(quaternion[k], place_of(names, Names(kQuaternion).subspan(k, 1)));
    if (quaternion[k] < names.size()) ++found;
  }
  if (found != 0 && found != quaternion.size())
    return bad("the header names some of qx, qy, qz, qw, not all", "give all four, or none");
  if (found != 0) columns.quaternion = quaternion;
  return std::optional(columns);
}

std::optional<std::array<double, 8>> parse_columns(std::string_view line, const TrajectoryColumns& columns) {
  const std::vector<std::string_view> fields = fields_of(line, columns.separator);
  std::array<double, 8> values = {0, 0, 0, 0, 0, 0, 0, 1};
  const auto take = [&](std::size_t column, double& value) {
    const auto number = column < fields.size() ? number_of(fields[column]) : std::nullopt;
    value = number.value_or(0);
    return number.has_value();
  };
  bool good = take(columns.time, values[0]);
  for (std::size_t k = 0; k < 3; ++k) good = take(columns.position[k], values[k + 1]) && good;
  for (std::size_t k = 0; k < 4 && columns.quaternion; ++k)
    good = take((*columns.quaternion)[k], values[k + 4]) && good;
  return good ? std::optional(values) : std::nullopt;
}

}  // namespace rayfield::formats
