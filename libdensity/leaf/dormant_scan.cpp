#include "libdensity/leaf/dormant_scan.h"

#include <fmt/core.h>

#include <cstdlib>
#include <utility>

#include "libdensity/season/vine_year.h"

namespace rayfield::density {
namespace {

constexpr double kFullLeafShare = 0.5;   // of the plant area at full leaf that wood has at most
constexpr double kGrowingShare = 0.95;   // of the plant area while leaves grow or fall
constexpr double kClearlyBarer = 0.75;   // of the plant area of another scan of the season
constexpr double kMostWoodPerMetre = 2;  // m²; unpruned vines show 0.3 to 1 in winter, evergreen orchards 2 to 10

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

}  // namespace rayfield::density
