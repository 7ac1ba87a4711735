#include "cli/scans/scan_date.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "rayfield/core/date.h"
#include "rayfield/core/map_frame.h"

namespace rayfield::cli {
namespace {

constexpr double kYear2000_s = 946684800, kHour_s = 3600, kMostTime_s = 1e11;
constexpr double kCivilFromSun_h = 3;  // Xinjiang and western Spain in summer are 2.5 h to 3 h ahead of the sun

std::string day_of(double time_s) { return utc_text(time_s).substr(0, 10); }

}  // namespace

// ISO dates order as texts do, so a date is right where it lies within the days of the earliest and latest reading.
std::optional<std::string> date_warning(const std::string& date, double start_s, double end_s, double longitude_deg) {
  if (!std::isfinite(start_s) || !std::isfinite(end_s) || start_s < kYear2000_s) return std::nullopt;
  const double sun_h = std::isfinite(longitude_deg) ? longitude_deg / 15 : 0;
  const double least_h = std::min(0.0, sun_h - kCivilFromSun_h), most_h = std::max(0.0, sun_h + kCivilFromSun_h);
  if (date >= day_of(start_s + least_h * kHour_s) && date <= day_of(end_s + most_h * kHour_s)) return std::nullopt;
  const std::string local = day_of(start_s + sun_h * kHour_s);
  return fmt::format("measured on {} by its own clock ({} UTC), not on {}: check --date", local,
                     utc_text(start_s).substr(0, 16), date);
}

Result<std::size_t> DatedSource::read(RayBatch& batch, std::size_t max_rays) {
  RAYFIELD_ASSIGN(const std::size_t count, source_.read(batch, max_rays));
  for (std::size_t i = 0; i < count; ++i) {
    if (!(std::abs(batch.time_s[i]) <= kMostTime_s)) continue;  // the store leaves these out
    first_s_ = std::min(first_s_, batch.time_s[i]), last_s_ = std::max(last_s_, batch.time_s[i]);
    if (!place_ && batch.origin[i].allFinite()) place_ = batch.origin[i];
  }
  return count;
}

std::vector<std::string> DatedSource::warnings() const {
  std::vector<std::string> warnings = source_.warnings();
  double longitude_deg = std::numeric_limits<double>::quiet_NaN();
  if (place_)
    if (const auto frame = MapFrame::create(crs_)) longitude_deg = frame->geodetic_from_map(*place_).y();
  if (auto warning = date_warning(date_, first_s_, last_s_, longitude_deg)) warnings.push_back(std::move(*warning));
  return warnings;
}

}  // namespace rayfield::cli
