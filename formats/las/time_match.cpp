#include "formats/las/time_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "formats/las/gps_time.h"
#include "formats/las/las_header.h"
#include "rayfield/core/date.h"

namespace rayfield::formats {
namespace {

// A Unix time before is the GPS time of a cloud, or the seconds of a week.
constexpr double kYear2000_s = 946684800;
// Seconds of the week run on where a drive goes past its end.
constexpr double kLongestWeek_s = 2 * kGpsWeek_s;

enum class Clock { unix_time, adjusted_gps, gps_week, other };

bool within_week(double time_s) { return time_s >= 0 && time_s < kLongestWeek_s; }

// Of a trajectory, which does not say it.
Clock clock_of(const TimeSpan& span) {
  if (span.start_s >= kYear2000_s) return Clock::unix_time;
  return within_week(span.start_s) && within_week(span.end_s) ? Clock::gps_week : Clock::other;
}

std::string leaps_text(double unix_s) { return fmt::format("{:.0f} leap seconds", leap_seconds(unix_s)); }

// Case 1. Times that count from elsewhere become Unix time where the cloud says from where.
TimeMatch same_clock(double middle_s, bool says_adjusted, const TimeSpan& trajectory) {
  TimeMatch match;
  match.text = "the times of cloud and trajectory are of one clock";
  if (clock_of(trajectory) == Clock::unix_time) {
    match.text += ", Unix time";
  } else if (says_adjusted) {
    match.to_unix_s = unix_time_of_adjusted(middle_s) - middle_s;
    match.text += ", adjusted standard GPS time: " + leaps_text(middle_s + match.to_unix_s) + " to UTC";
  } else {
    match.has_date = false;
    match.text += ", of which nothing says from when it counts";
  }
  return match;
}

// Case 2.
TimeMatch adjusted_to_unix(double middle_s) {
  TimeMatch match;
  const double unix_s = unix_time_of_adjusted(middle_s);
  match.to_trajectory_s = unix_s - middle_s;
  match.text = "the cloud has adjusted standard GPS time, the trajectory Unix time: " + leaps_text(unix_s);
  return match;
}

// Case 3.
TimeMatch adjusted_to_week(double middle_s, double trajectory_middle_s) {
  TimeMatch match;
  match.by_week = true;
  match.to_trajectory_s = kGpsTimeAdjustment_s;
  match.middle_s = trajectory_middle_s;
  const double unix_s = unix_time_of_adjusted(middle_s);
  match.to_unix_s = unix_s - match.trajectory_time(middle_s);
  match.text =
      "the cloud has adjusted standard GPS time, the trajectory seconds of the GPS week: " + leaps_text(unix_s) +
      " to UTC";
  return match;
}

// Case 4.
TimeMatch week_to_unix(double trajectory_middle_s) {
  TimeMatch match;
  match.by_week = true;
  match.to_trajectory_s = kGpsEpoch_s - leap_seconds(trajectory_middle_s);
  match.middle_s = trajectory_middle_s;
  match.text = "the cloud has seconds of the GPS week, the trajectory Unix time: " + leaps_text(trajectory_middle_s);
  return match;
}

double share_inside(std::span<const double> times_s, const TimeMatch& match, const TimeSpan& span, double tolerance_s) {
  const auto inside = std::count_if(times_s.begin(), times_s.end(), [&](double t) {
    const double at_s = match.trajectory_time(t);
    return at_s >= span.start_s - tolerance_s && at_s <= span.end_s + tolerance_s;
  });
  return static_cast<double>(inside) / static_cast<double>(times_s.size());
}

std::string span_text(double start_s, double end_s, bool is_unix) {
  const std::string text = fmt::format("{:.13g} to {:.13g}", start_s, end_s);
  return is_unix ? fmt::format("{} ({} to {})", text, utc_text(start_s), utc_text(end_s)) : text;
}

tl::unexpected<Error> no_match(double first_s, double last_s, bool says_adjusted, const TimeSpan& trajectory) {
  std::string cloud = span_text(first_s, last_s, !says_adjusted && first_s >= kYear2000_s);
  if (says_adjusted)
    cloud += fmt::format(" (adjusted standard GPS time: {} to {})", utc_text(unix_time_of_adjusted(first_s)),
                         utc_text(unix_time_of_adjusted(last_s)));
  return fail(
      ErrorCode::bad_input, kLasWhat, {},
      fmt::format("none of its points was measured during the trajectory: the cloud's times are {}, those of the "
                  "trajectory {}",
                  cloud, span_text(trajectory.start_s, trajectory.end_s, clock_of(trajectory) == Clock::unix_time)),
      "give the trajectory of the same drive, in Unix time or in the cloud's own");
}

}  // namespace

double TimeMatch::trajectory_time(double point_s) const {
  const double time_s = point_s + to_trajectory_s;
  return by_week ? middle_s + std::remainder(time_s - middle_s, kGpsWeek_s) : time_s;
}

Result<TimeMatch> match_times(std::span<const double> times_s, bool says_adjusted, const TimeSpan& trajectory,
                              double tolerance_s) {
  std::vector<double> times;
  std::copy_if(times_s.begin(), times_s.end(), std::back_inserter(times), [](double t) { return std::isfinite(t); });
  if (times.empty())
    return fail(ErrorCode::bad_input, kLasWhat, {}, "none of its points has a time", "export the cloud with its times");
  std::sort(times.begin(), times.end());
  const double middle_s = times[times.size() / 2], trajectory_middle_s = (trajectory.start_s + trajectory.end_s) / 2;
  const Clock clock = clock_of(trajectory);
  std::vector<TimeMatch> matches = {same_clock(middle_s, says_adjusted, trajectory)};
  if (clock == Clock::unix_time) matches.push_back(adjusted_to_unix(middle_s));
  if (clock == Clock::gps_week) matches.push_back(adjusted_to_week(middle_s, trajectory_middle_s));
  if (clock == Clock::unix_time && within_week(times.front()) && within_week(times.back()))
    matches.push_back(week_to_unix(trajectory_middle_s));
  const TimeMatch* best = &matches.front();
  for (TimeMatch& match : matches) {
    match.inside = share_inside(times, match, trajectory, tolerance_s);
    if (match.inside > best->inside) best = &match;
  }
  if (best->inside == 0) return no_match(times.front(), times.back(), says_adjusted, trajectory);
  TimeMatch match = *best;
  const bool took_week = match.by_week && clock == Clock::unix_time;
  const bool took_adjusted = best != &matches.front() && !took_week;
  if (took_adjusted && !says_adjusted) match.text += " (its header says seconds of the week)";
  if (took_week && says_adjusted) match.text += " (its header says adjusted standard GPS time)";
  return match;
}

}  // namespace rayfield::formats
