#include "formats/las/gps_time.h"

#include <algorithm>
#include <array>

namespace rayfield::formats {
namespace {

/// Unix times at which a leap second had just been added since then (IERS Bulletin C).
constexpr std::array<double, 18> kLeaps{
    362793600,   // 1981-07-01
    394329600,   // 1982-07-01
    425865600,   // 1983-07-01
    489024000,   // 1985-07-01
    567993600,   // 1988-01-01
    631152000,   // 1990-01-01
    662688000,   // 1991-01-01
    709948800,   // 1992-07-01
    741484800,   // 1993-07-01
    773020800,   // 1994-07-01
    820454400,   // 1996-01-01
    867715200,   // 1997-07-01
    915148800,   // 1999-01-01
    1136073600,  // 2006-01-01
    1230768000,  // 2009-01-01
    1341100800,  // 2012-07-01
    1435708800,  // 2015-07-01
    1483228800,  // 2017-01-01
};

}  // namespace

double leap_seconds(double unix_time_s) {
  return static_cast<double>(std::upper_bound(kLeaps.begin(), kLeaps.end(), unix_time_s) - kLeaps.begin());
}

double adjusted_gps_time(double unix_time_s) {
  // The whole seconds first: their difference is exact, and smaller than what the fraction is added to.
  return (unix_time_s - (kGpsEpoch_s + kGpsTimeAdjustment_s)) + leap_seconds(unix_time_s);
}

double unix_time_of_adjusted(double adjusted_gps_s) {
  const double without_leaps = adjusted_gps_s + (kGpsEpoch_s + kGpsTimeAdjustment_s);
  // On a clock that counts leap seconds the one before kLeaps[k] begins k seconds later, and lasts a second.
  std::size_t leaps = 0;
  while (leaps < kLeaps.size() && without_leaps - static_cast<double>(leaps) >= kLeaps[leaps] + 1) ++leaps;
  return without_leaps - static_cast<double>(leaps);
}

}  // namespace rayfield::formats
