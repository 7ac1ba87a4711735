#include "libdensity/leaf/scan_totals.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "libdensity/scan/stage_versions.h"

namespace rayfield::density {
namespace {

using nlohmann::json;

constexpr const char* kKind = "totals";
constexpr const char* kPanels = "thin_plants";  // attribute: uids of the panels of the columns
constexpr const char* kAreas = "thin_plant_area_m2";
constexpr const char* kHighs = "thin_plant_high_m2";

void put_thin_plants(const PanelPlants& plants, tile::ArraySet& arrays) {
  std::vector<std::string> uids;
  std::vector<double> areas, highs;
  for (const auto& [uid, seen] : plants)
    uids.push_back(uid), areas.push_back(seen.area_m2), highs.push_back(seen.high_m2);
  arrays.attributes = json{{kPanels, uids}}.dump();
  arrays.columns[kAreas] = std::move(areas), arrays.columns[kHighs] = std::move(highs);
}

Result<PanelPlants> thin_plants_of(const tile::ArraySet& arrays) {
  PanelPlants plants;
  if (!arrays.columns.contains(kAreas)) return plants;  // of an earlier version
  RAYFIELD_ASSIGN(const auto areas, arrays.column<double>(kAreas));
  RAYFIELD_ASSIGN(const auto highs, arrays.column<double>(kHighs));
  const json attributes = json::parse(arrays.attributes, nullptr, /*allow_exceptions=*/false);
  const json uids = attributes.is_object() ? attributes.value(kPanels, json::array()) : json::array();
  const auto is_text = [](const json& uid) { return uid.is_string(); };
  const auto is_finite = [](double area_m2) { return std::isfinite(area_m2); };
  if (uids.size() != areas.size() || areas.size() != highs.size() || !std::all_of(uids.begin(), uids.end(), is_text) ||
      !std::all_of(areas.begin(), areas.end(), is_finite) || !std::all_of(highs.begin(), highs.end(), is_finite))
    return fail(ErrorCode::damaged, "cannot read derived data", kKind, "its panels have not one value each",
                "run `rayfield verify`");
  for (std::size_t i = 0; i < areas.size(); ++i) plants[uids[i].get<std::string>()] = {areas[i], highs[i]};
  return plants;
}

}  // namespace

tile::ArraySet arrays_from_totals(const ScanTotals& totals) {
  tile::ArraySet arrays{.kind = kKind};
  put_thin_plants(totals.thin_plants, arrays);
  arrays.columns["plant_area_m2"] = std::vector<double>{totals.plant_area_m2};
  arrays.columns["panel_length_m"] = std::vector<double>{totals.panel_length_m};
  arrays.columns["panels"] = std::vector<std::int32_t>{totals.panels};
  arrays.columns["panels_with_value"] = std::vector<std::int32_t>{totals.panels_with_value};
  arrays.columns["observed_fraction"] = std::vector<double>{totals.observed_fraction};
  arrays.columns["holds_downward_misses"] =
      std::vector<std::uint8_t>{static_cast<std::uint8_t>(totals.holds_downward_misses ? 1 : 0)};
  return arrays;
}

Result<ScanTotals> totals_from_arrays(const tile::ArraySet& arrays) {
  RAYFIELD_ASSIGN(const auto area, arrays.column<double>("plant_area_m2"));
  RAYFIELD_ASSIGN(const auto length, arrays.column<double>("panel_length_m"));
  RAYFIELD_ASSIGN(const auto misses, arrays.column<std::uint8_t>("holds_downward_misses"));
  if (area.size() != 1 || length.size() != 1 || misses.size() != 1)
    return fail(ErrorCode::damaged, "cannot read derived data", kKind, "it has no single values",
                "run `rayfield verify`");
  ScanTotals totals;
  totals.plant_area_m2 = area[0], totals.panel_length_m = length[0], totals.holds_downward_misses = misses[0] != 0;
  RAYFIELD_ASSIGN(totals.thin_plants, thin_plants_of(arrays));
  const auto panels = arrays.column<std::int32_t>("panels"), seen = arrays.column<std::int32_t>("panels_with_value");
  const auto observed = arrays.column<double>("observed_fraction");
  // Of an earlier version: what another scan wants to know is there.
  if (!panels || !seen || !observed || panels->size() != 1 || seen->size() != 1 || observed->size() != 1) return totals;
  totals.panels = (*panels)[0], totals.panels_with_value = (*seen)[0], totals.observed_fraction = (*observed)[0];
  return totals;
}

std::optional<double> ScanTotals::plant_area_per_m() const {
  if (!(panel_length_m > 0)) return std::nullopt;
  return plant_area_m2 / panel_length_m;
}

Result<ScanTotals> total_scan(ScanWork& work, const RowLayout& layout, const ScanResults& results,
                              bool holds_downward_misses) {
  KeyBuilder key(kKind, kTotalsVersion);
  key.add(work.files.sha256("results", "block")).add(std::int64_t{holds_downward_misses ? 1 : 0}).add(work.layout_key);
  const auto make = [&]() -> Result<tile::ArraySet> {
    std::map<std::string, double> lengths;
    for (const Panel& panel : layout.panels) lengths[panel.identity.uid] = panel.end_m - panel.start_m;
    ScanTotals totals;
    totals.holds_downward_misses = holds_downward_misses;
    totals.panels = static_cast<int>(layout.panels.size());
    double observed = 0;
    for (const PanelValue& value : results.panel_values) {
      if (std::isfinite(value.observed_fraction)) observed += value.observed_fraction;
      if (std::isfinite(value.leaf_area_m2))
        totals.thin_plants[value.panel_uid] = {value.leaf_area_m2, value.ci_high_m2};
      if (!std::isfinite(value.plant_area_m2)) continue;
      ++totals.panels_with_value;
      totals.plant_area_m2 += value.plant_area_m2, totals.panel_length_m += lengths[value.panel_uid];
    }
    if (totals.panels > 0) totals.observed_fraction = observed / totals.panels;
    return arrays_from_totals(totals);
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get(kKind, "block", key.hex(), make));
  return totals_from_arrays(arrays);
}

Result<std::optional<ScanTotals>> read_totals(const tile::Store& store, const tile::ScanEntry& scan) {
  for (const tile::DerivedEntry& entry : scan.derived) {
    if (entry.kind != kKind) continue;
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(entry));
    RAYFIELD_ASSIGN(const ScanTotals totals, totals_from_arrays(arrays));
    return std::optional(totals);
  }
  return std::optional<ScanTotals>();
}

}  // namespace rayfield::density
