#pragma once

#include <span>
#include <string>

#include "rayfield/core/result.h"

namespace rayfield::formats {

/// First and last time of a trajectory, s, in whatever clock it has.
struct TimeSpan {
  double start_s = 0, end_s = 0;
};

/// How the times of a cloud's points become those of its trajectory, and Unix time.
struct TimeMatch {
  double to_trajectory_s = 0;  ///< added to a point's time
  bool by_week = false;        ///< then whole GPS weeks are added, so that it comes nearest to middle_s
  double middle_s = 0;         ///< of the trajectory
  double to_unix_s = 0;        ///< added to the trajectory's time
  bool has_date = true;        ///< false: both clocks are seconds of the GPS week, of which week nothing says
  double inside = 0;           ///< share of the times that lie within the trajectory's span
  std::string text;            ///< the assumption, for people

  double trajectory_time(double point_s) const;
};

/// Finds how the clocks of a cloud and of a trajectory belong together: the first of the following by which most of
/// the cloud's times lie within the span (`tolerance_s` at both ends).
///   1. both have one clock
///   2. the cloud has adjusted standard GPS time, the trajectory Unix time: leap seconds as of that day
///   3. the cloud has adjusted standard GPS time, the trajectory seconds of the GPS week
///   4. the cloud has seconds of the GPS week, the trajectory Unix time: the week that is nearest to its middle
/// `times_s`: some of the cloud's times, finite ones count. `says_adjusted`: bit 0 of the file's global encoding, which
/// is said where it contradicts what was found; writers forget it. Errors: bad_input (no time lies in the span; both
/// spans are named, nothing stands in `where`).
Result<TimeMatch> match_times(std::span<const double> times_s, bool says_adjusted, const TimeSpan& trajectory,
                              double tolerance_s);

}  // namespace rayfield::formats
