#include "libdensity/leaf/dormant_scan.h"

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "rayfield/core/date.h"
#include "rayfield/core/map_frame.h"

namespace rayfield::density {
namespace {

constexpr double kTropics_deg = 20;     // nearer to the equator vines may bear leaves all the year
constexpr double kFullLeafShare = 0.5;  // of the plant area at full leaf that wood has at most
constexpr double kGrowingShare = 0.95;  // of the plant area while leaves grow or fall
constexpr long kHalfAYear_days = 182;
constexpr double kClearlyBarer = 0.75;   // of the plant area of another scan of the season
constexpr double kMostWoodPerMetre = 2;  // m²; unpruned vines show 0.3 to 1 in winter, evergreen orchards 2 to 10

// Of a scan of the store, whose dates are checked when it is added.
std::chrono::year_month_day calendar_day(const std::string& date) { return parse_calendar_day(date).value(); }

long days_between(const std::string& a, const std::string& b) {
  return (std::chrono::sys_days(calendar_day(b)) - std::chrono::sys_days(calendar_day(a))).count();
}

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

bool in_one_season(const std::string& a, const std::string& b, std::optional<double> latitude_deg) {
  if (!latitude_deg || !(std::abs(*latitude_deg) > kTropics_deg))
    return std::labs(days_between(a, b)) <= kHalfAYear_days;
  return growing_season(a, *latitude_deg) == growing_season(b, *latitude_deg);
}

// December to February in the south: canopies are as large as they get.
bool is_full_leaf_season(const std::string& date, double latitude_deg) {
  const int at = southern_month_day(date, latitude_deg);
  return std::abs(latitude_deg) > kTropics_deg && (at >= 1201 || at < 301);
}

std::string shows_much(double plant_area_per_m, const std::string& against) {
  return fmt::format(
      "is of the leafless months, but shows {:.2f} m² of plants per metre of row, which is not little{}; "
      "if the vines bore no leaves, say so: `rayfield add … --dormant yes`",
      plant_area_per_m, against);
}

// Held against the scans of the months with leaves; where there are none, against what wood there can be.
DormantVerdict dormant_verdict(const ScanSeason& scan, std::span<const ScanSeason> scans, double latitude_deg) {
  if (!scan.plant_area_per_m) return {false, "is of the leafless months, but has not been processed"};
  bool held_against_leaves = false;
  for (const ScanSeason& other : scans) {
    if (!other.plant_area_per_m || is_leafless_season(other.date, latitude_deg) || other.declared == true) continue;
    held_against_leaves = true;
    const double share = is_full_leaf_season(other.date, latitude_deg) ? kFullLeafShare : kGrowingShare;
    if (*scan.plant_area_per_m <= share * *other.plant_area_per_m) continue;
    const std::string against = fmt::format(" against the {:.2f} m² of {}", *other.plant_area_per_m, other.scan_id);
    return {false, shows_much(*scan.plant_area_per_m, against)};
  }
  if (!held_against_leaves && *scan.plant_area_per_m > kMostWoodPerMetre)
    return {false, shows_much(*scan.plant_area_per_m, " (evergreen orchards bear leaves then)")};
  return {true, "is taken as dormant: it is of the leafless months and shows little"};
}

}  // namespace

bool is_leafless_season(const std::string& date, double latitude_deg) {
  if (!(std::abs(latitude_deg) > kTropics_deg)) return false;
  const int at = southern_month_day(date, latitude_deg);
  return at >= 601 && at <= 910;
}

std::vector<DormantVerdict> find_dormant_scans(std::span<const ScanSeason> scans, std::optional<double> latitude_deg) {
  std::vector<DormantVerdict> verdicts;
  for (const ScanSeason& scan : scans) {
    if (scan.declared) {
      verdicts.push_back({*scan.declared, *scan.declared ? "is dormant, as declared" : "is not dormant, as declared"});
    } else if (latitude_deg && is_leafless_season(scan.date, *latitude_deg)) {
      verdicts.push_back(dormant_verdict(scan, scans, *latitude_deg));
    } else {
      verdicts.push_back({});
    }
  }
  return verdicts;
}

std::optional<std::size_t> wood_scan_of(std::size_t scan, std::span<const ScanSeason> scans,
                                        std::span<const DormantVerdict> verdicts) {
  if (verdicts[scan].dormant) return scan;
  std::optional<std::size_t> nearest;
  long least = 0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (!verdicts[i].dormant || !scans[i].plant_area_per_m) continue;
    const long days = std::labs(days_between(scans[scan].date, scans[i].date));
    if (nearest && (days > least || (days == least && scans[*nearest].date <= scans[i].date))) continue;
    nearest = i, least = days;
  }
  return nearest;
}

std::optional<std::size_t> barest_scan_of(std::size_t scan, std::span<const ScanSeason> scans,
                                          std::optional<double> latitude_deg) {
  std::optional<std::size_t> barest;
  if (!scans[scan].plant_area_per_m) return barest;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (i == scan || !scans[i].plant_area_per_m) continue;
    if (*scans[i].plant_area_per_m > kClearlyBarer * *scans[scan].plant_area_per_m) continue;
    if (!in_one_season(scans[scan].date, scans[i].date, latitude_deg)) continue;
    if (!barest || std::pair(*scans[i].plant_area_per_m, scans[i].date) <
                       std::pair(*scans[*barest].plant_area_per_m, scans[*barest].date))
      barest = i;
  }
  return barest;
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
