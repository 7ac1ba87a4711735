#pragma once

namespace rayfield::formats {

inline constexpr double kGpsWeek_s = 604800;
/// What adjusted standard GPS time has less than GPS time (LAS 1.4 R15, "Global Encoding"), s.
inline constexpr double kGpsTimeAdjustment_s = 1e9;
/// Unix time of 1980-01-06T00:00:00Z, where GPS time begins.
inline constexpr double kGpsEpoch_s = 315964800;

/// Seconds by which GPS time is ahead of UTC at a moment: the leap seconds since 1980. Knows those up to that of
/// 2017-01-01, the last so far (IERS Bulletin C).
double leap_seconds(double unix_time_s);

/// Adjusted standard GPS time of a moment, s: seconds since 1980-01-06T00:00:00Z, leap seconds counted, less 10⁹ (LAS
/// 1.4 R15, "Global Encoding").
double adjusted_gps_time(double unix_time_s);

/// The inverse of adjusted_gps_time(): Unix time, s. A leap second itself has the time of the second after it.
double unix_time_of_adjusted(double adjusted_gps_s);

}  // namespace rayfield::formats
