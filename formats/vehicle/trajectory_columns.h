#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "rayfield/core/result.h"

namespace rayfield::formats {

/// Where the numbers of a pose stand in the lines of a table of text, by the names in its header line.
struct TrajectoryColumns {
  char separator = ',';  ///< ',', ';', a tab, or a space for any white space
  std::size_t time = 0;
  std::array<std::size_t, 3> position{};                 ///< easting, northing, height
  std::optional<std::array<std::size_t, 4>> quaternion;  ///< x y z w

  /// t x y z qx qy qz qw between white space.
  bool are_tum() const;
};

/// The columns that a header line names, in any order and any case, units in brackets left out:
///   t, time, timestamp, gps_time, gps_seconds, … · x, tx, easting, east · y, ty, northing, north ·
///   z, tz, height, altitude, elevation, up · qx qy qz qw (all four or none)
/// A leading % or # is left out, as raycloudtools and others write one. Nothing where the line names no time: then it
/// is no header. Errors: bad_input with the reason in `why` (a column is missing or there twice, degrees).
Result<std::optional<TrajectoryColumns>> find_trajectory_columns(std::string_view line);

/// t x y z qx qy qz qw of a line, qx qy qz qw 0 0 0 1 where there are no such columns; nothing where a number is
/// missing, not finite, or something else. Other columns may hold anything.
std::optional<std::array<double, 8>> parse_columns(std::string_view line, const TrajectoryColumns& columns);

}  // namespace rayfield::formats
