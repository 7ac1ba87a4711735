#include "rayfield/sim/site.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "rayfield/core/date.h"
#include "rayfield/core/map_frame.h"
#include "sim/site/site_fields.h"

namespace rayfield::sim {
namespace {

// Visits every field and keeps the first that lies outside its range.
class RangeChecker {
 public:
  SiteFinding finding;

  void enter(std::string_view table) { prefix_ = std::string(table) + "."; }
  void leave() { prefix_.clear(); }
  void number(std::string_view key, double value, double low, double high) {
    if (!(value >= low && value <= high)) complain(key, fmt::format("{} is outside {} … {}", value, low, high));
  }
  template <class T>
  void integer(std::string_view key, T value, double low, double high) {
    number(key, static_cast<double>(value), low, high);
  }
  void flag(std::string_view, bool) {}
  void text(std::string_view, const std::string&) {}
  template <class E, std::size_t N>
  void choice(std::string_view, E, const Choices<E, N>&) {}
  template <class T>
  void numbers(std::string_view key, const std::vector<T>& values, double low, double high, std::size_t most) {
    if (values.size() > most) complain(key, fmt::format("more than {} values", most));
    for (const T& value : values) number(key, static_cast<double>(value), low, high);
  }
  void integers(std::string_view key, const std::vector<int>& values, double low, double high, std::size_t most) {
    numbers(key, values, low, high, most);
  }
  void vector3(std::string_view key, const Eigen::Vector3d& value) {
    for (int axis = 0; axis < 3; ++axis) number(key, value[axis], -10, 10);
  }
  void rigid(std::string_view key, const Rigid3& value) {
    vector3(key, value.translation);
    if (!(std::abs(value.rotation.norm() - 1) < 1e-6)) complain(key, "the quaternion is not of unit length");
  }
  template <class T, class F>
  void tables(std::string_view key, std::vector<T>& items, F&& visit) {
    const std::string outer = prefix_;
    for (std::size_t i = 0; i < items.size(); ++i) {
      prefix_ = fmt::format("{}{}[{}].", outer, key, i);
      visit(items[i]);
    }
    prefix_ = outer;
  }

 private:
  std::string prefix_;
  void complain(std::string_view key, std::string why) {
    if (finding.key.empty()) finding = {prefix_ + std::string(key), std::move(why)};
  }
};

SiteFinding check_rows(const Site& site) {
  const SiteRows& rows = site.rows;
  const double rest = std::fmod(rows.length_m, rows.panel_length_m);
  if (rest > 1e-6 && rest < 1 && rows.panel_length_m - rest > 1e-6)
    return {"rows.panel_length_m", "it leaves a last panel shorter than 1 m"};
  const double half_width = 0.5 * (rows.count + 1) * rows.spacing_m;
  if (rows.curve_radius_m != 0 && std::abs(rows.curve_radius_m) < std::max(2 * half_width, rows.length_m / 2))
    return {"rows.curve_radius_m", "the curve is tighter than the block's width or half its length"};
  const SiteCanopy& canopy = site.canopy;
  if (canopy.top_m <= canopy.bottom_m) return {"canopy.top_m", "it does not lie above bottom_m"};
  if (canopy.leaf_size_max_cm2 < canopy.leaf_size_min_cm2)
    return {"canopy.leaf_size_max_cm2", "it is smaller than leaf_size_min_cm2"};
  const double leaves = canopy.leaf_area_m2_per_m * rows.length_m * rows.count /
                        (0.5e-4 * (canopy.leaf_size_min_cm2 + canopy.leaf_size_max_cm2));
  if (leaves > 50e6)
    return {"canopy.leaf_area_m2_per_m", fmt::format("{:.0f} million leaves do not fit", leaves / 1e6)};
  const double blades = site.terrain.grass_per_m2 * (rows.length_m + 2) * (rows.count + 1) * rows.spacing_m;
  if (blades > 50e6) return {"terrain.grass_per_m2", fmt::format("{:.0f} million blades do not fit", blades / 1e6)};
  if (rows.length_m * (rows.count + 1) * rows.spacing_m > 1e6) return {"rows.count", "the block is larger than 100 ha"};
  return {};
}

SiteFinding check_sensors(const Site& site) {
  if (site.lidar.max_range_m <= site.lidar.min_range_m) return {"lidar.max_range_m", "it does not exceed min_range_m"};
  if (site.lidar.divergence_z_mrad > 0 && site.lidar.divergence_mrad == 0)
    return {"lidar.divergence_z_mrad", "it needs divergence_mrad beside it"};
  if (site.lidar.echoes > 1 && site.lidar.returns != ReturnMode::first)
    return {"lidar.echoes", "several of them begin with the first: leave returns out"};
  if (site.spinning.time_increment_s * site.spinning.beams > 1 / site.spinning.rate_hz)
    return {"spinning.time_increment_s", "a scan takes longer than the time to the next"};
  if (site.multi_beam.elevation_max_deg < site.multi_beam.elevation_min_deg)
    return {"multi_beam.elevation_max_deg", "it is smaller than elevation_min_deg"};
  return {};
}

SiteFinding check_dates(const Site& site) {
  if (site.dates.empty()) return {"date", "there is none; give at least one [[date]]"};
  std::set<std::string> labels;
  for (std::size_t i = 0; i < site.dates.size(); ++i) {
    const SiteDate& date = site.dates[i];
    const std::string key = fmt::format("date[{}]", i);
    if (!parse_date(date.date)) return {key + ".date", "'" + date.date + "' is not a date YYYY-MM-DD"};
    const std::string& label = date.label();
    if (label.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-") !=
            std::string::npos ||
        label.front() == '.')
      return {key + ".name", "it may hold letters, digits, '-', '_' and '.' only and not start with a dot"};
    if (!labels.insert(label).second)
      return {key + (date.name.empty() ? ".date" : ".name"), "'" + label + "' occurs twice"};
    for (const int lane : date.lanes)
      if (lane > site.rows.count)
        return {key + ".lanes", fmt::format("lane {} does not exist, the lanes are 0 … {}", lane, site.rows.count)};
    for (std::size_t k = 1; k < date.lanes.size(); ++k)
      if (date.lanes[k] == date.lanes[k - 1])
        return {key + ".lanes", fmt::format("lane {} follows itself", date.lanes[k])};
  }
  return {};
}

}  // namespace

SiteMount::SiteMount() {
  imu_from_spinner.translation = {0.06, 0, 0.11};
  imu_from_spinner.rotation = Eigen::Quaterniond(0.999992366, 0.00150598967, -0.00299698614, 0.0020044874).normalized();
  spinner_from_lidar.translation = {0.035, 0, 0.02};
  spinner_from_lidar.rotation = Eigen::Quaterniond(std::sqrt(0.5), std::sqrt(0.5), 0, 0);
  imu_from_lidar.translation = {0.08, 0, 0.14};
  imu_from_lidar.rotation = imu_from_spinner.rotation;
}

SiteFinding check_consistency(const Site& site) {
  for (const auto check : {check_rows, check_sensors, check_dates}) {
    SiteFinding finding = check(site);
    if (!finding.key.empty()) return finding;
  }
  if (const auto crs = lookup_projected_crs(site.crs_code()); !crs) return {"site.crs", crs.error().why};
  return {};
}

Result<void> Site::validate() const {
  Site copy = *this;  // visitors take references that they may write to
  RangeChecker checker;
  visit_site(checker, copy);
  SiteFinding finding = checker.finding;
  if (finding.key.empty()) finding = check_consistency(*this);
  if (finding.key.empty()) return {};
  return fail(ErrorCode::usage, "cannot use site", finding.key, finding.why, "see docs/simulation.md for the keys");
}

std::string default_crs(double latitude_deg, double longitude_deg) {
  const int zone = std::clamp(static_cast<int>(std::floor((longitude_deg + 180) / 6)) + 1, 1, 60);
  const bool australia = latitude_deg > -44 && latitude_deg < -10 && longitude_deg >= 108 && longitude_deg < 156;
  if (australia) return fmt::format("EPSG:{}", 7800 + zone);
  return fmt::format("EPSG:{}", (latitude_deg >= 0 ? 32600 : 32700) + zone);
}

std::string Site::crs_code() const { return crs.empty() ? default_crs(latitude_deg, longitude_deg) : crs; }

}  // namespace rayfield::sim
