#include "libdensity/season/vine_year.h"

#include <chrono>
#include <cmath>
#include <cstdlib>

#include "rayfield/core/date.h"
#include "rayfield/core/map_frame.h"

namespace rayfield::density {
namespace {

constexpr double kTropics_deg = 20;  // nearer to the equator vines may bear leaves all the year
constexpr long kHalfAYear_days = 182;

// Of a scan of the store, whose dates are checked when it is added.
std::chrono::year_month_day calendar_day(const std::string& date) { return parse_calendar_day(date).value(); }

// Month and day as in the southern hemisphere, whose seasons are half a year off: 100·month + day.
int southern_month_day(const std::string& date, double latitude_deg) {
  const std::chrono::year_month_day day = calendar_day(date);
  const unsigned month = static_cast<unsigned>(day.month());
  const unsigned southern = latitude_deg < 0 ? month : (month + 5) % 12 + 1;
  return static_cast<int>(100 * southern + static_cast<unsigned>(day.day()));
}

// From the middle of one winter to that of the next.
int growing_season(const std::string& date, double latitude_deg) {
  const std::chrono::year_month_day day = calendar_day(date);
  const unsigned first_month = latitude_deg < 0 ? 8 : 2;
  return static_cast<int>(day.year()) + (static_cast<unsigned>(day.month()) >= first_month ? 1 : 0);
}

}  // namespace

bool is_leafless_season(const std::string& date, double latitude_deg) {
  if (!(std::abs(latitude_deg) > kTropics_deg)) return false;
  const int at = southern_month_day(date, latitude_deg);
  return at >= 601 && at <= 910;
}

bool is_full_leaf_season(const std::string& date, double latitude_deg) {
  const int at = southern_month_day(date, latitude_deg);
  return std::abs(latitude_deg) > kTropics_deg && (at >= 1201 || at < 301);
}

bool in_one_season(const std::string& a, const std::string& b, std::optional<double> latitude_deg) {
  if (!latitude_deg || !(std::abs(*latitude_deg) > kTropics_deg))
    return std::labs(days_between(a, b)) <= kHalfAYear_days;
  return growing_season(a, *latitude_deg) == growing_season(b, *latitude_deg);
}

long days_between(const std::string& a, const std::string& b) {
  return (std::chrono::sys_days(calendar_day(b)) - std::chrono::sys_days(calendar_day(a))).count();
}

std::optional<double> latitude_of(const tile::ScanEntry& scan, const std::string& crs) {
  if (scan.origin_bounds.isEmpty()) return std::nullopt;
  const auto frame = MapFrame::create(crs);
  if (!frame) return std::nullopt;
  const double latitude = frame->geodetic_from_map(scan.origin_bounds.center()).x();
  if (!std::isfinite(latitude) || std::abs(latitude) > 90) return std::nullopt;
  return latitude;
}

}  // namespace rayfield::density
