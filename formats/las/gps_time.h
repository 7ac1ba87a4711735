#pragma once

namespace rayfield::formats {

/// Adjusted standard GPS time of a moment, s: seconds since 1980-01-06T00:00:00Z, leap seconds counted, less 10⁹ (LAS
/// 1.4 R15, "Global Encoding"). Knows the leap seconds up to that of 2017-01-01, the last so far.
double adjusted_gps_time(double unix_time_s);

}  // namespace rayfield::formats
