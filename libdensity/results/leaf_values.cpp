#include "libdensity/results/leaf_values.h"

#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "libdensity/results/stored_descriptors.h"

namespace rayfield::density {
namespace {

using nlohmann::json;

constexpr const char* kKind = "leaf";
constexpr int kVersion = 1;

constexpr std::array<std::pair<const char*, double PanelValue::*>, 6> kPanelColumns{{
    {"panel_leaf_area_m2", &PanelValue::leaf_area_m2},
    {"panel_leaf_area_per_m", &PanelValue::leaf_area_per_m},
    {"panel_lai", &PanelValue::lai},
    {"panel_se_leaf_area_m2", &PanelValue::se_leaf_area_m2},
    {"panel_ci_low_m2", &PanelValue::ci_low_m2},
    {"panel_ci_high_m2", &PanelValue::ci_high_m2},
}};

tl::unexpected<Error> damaged(const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read leaf areas", kKind, why, "run `rayfield verify`");
}

// Stored leaf areas of earlier versions have no profile: then it is undefined.
Result<void> take_profile(const tile::ArraySet& arrays, ScanResults& results) {
  for (PanelProfileBand& band : results.profile) band.leaf_area_m2 = CanopyDescriptors::kUndefined;
  if (!arrays.columns.contains("profile_leaf_area_m2")) return {};
  RAYFIELD_ASSIGN(const auto leaf, arrays.column<double>("profile_leaf_area_m2"));
  if (leaf.size() != results.profile.size()) return damaged("not as many bands of profiles as results");
  for (std::size_t i = 0; i < leaf.size(); ++i) results.profile[i].leaf_area_m2 = leaf[i];
  return {};
}

}  // namespace

tile::ArraySet leaf_to_arrays(const LeafValues& leaf, const RowLayout& layout) {
  tile::ArraySet arrays;
  arrays.kind = kKind, arrays.version = kVersion;
  arrays.attributes = json{{"wood_scan_id", leaf.wood_scan_id}, {"wood_content", leaf.wood_content}}.dump();
  std::map<std::string, const Panel*> panels;
  for (const Panel& panel : layout.panels) panels[panel.identity.uid] = &panel;
  std::vector<std::int32_t> row, number;
  for (const PanelValue& value : leaf.panels) {
    const Panel* panel = panels.at(value.panel_uid);
    row.push_back(panel->row), number.push_back(panel->number);
  }
  arrays.columns["panel_row"] = std::move(row);
  arrays.columns["panel_number"] = std::move(number);
  for (const auto& [name, member] : kPanelColumns) {
    std::vector<double> column;
    for (const PanelValue& value : leaf.panels) column.push_back(value.*member);
    arrays.columns[name] = std::move(column);
  }
  std::vector<double> metres;
  for (const RowMetreProduct& metre : leaf.metres) metres.push_back(metre.leaf_area_per_m);
  arrays.columns["metre_leaf_area_per_m"] = std::move(metres);
  arrays.columns["profile_leaf_area_m2"] = leaf.profile;
  put_descriptors(kLeafDescriptors, "panel_", leaf.panels, arrays);
  put_descriptors(kLeafDescriptors, "metre_", leaf.metres, arrays);
  return arrays;
}

Result<void> put_leaf_values(const tile::ArraySet& arrays, const RowLayout& layout, ScanResults& results) {
  RAYFIELD_ASSIGN(const WoodSource source, wood_source_of(arrays));
  std::map<std::string, PanelValue*> values;
  for (PanelValue& value : results.panel_values) values[value.panel_uid] = &value;
  std::map<std::pair<int, int>, std::string> uids;
  for (const Panel& panel : layout.panels) uids[{panel.row, panel.number}] = panel.identity.uid;

  RAYFIELD_ASSIGN(const auto row, arrays.column<std::int32_t>("panel_row"));
  RAYFIELD_ASSIGN(const auto number, arrays.column<std::int32_t>("panel_number"));
  if (row.size() != values.size() || number.size() != values.size()) return damaged("not as many panels as results");
  std::vector<PanelValue*> panels;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const auto uid = uids.find({row[i], number[i]});
    const auto value = uid == uids.end() ? values.end() : values.find(uid->second);
    if (value == values.end()) return damaged("a panel is not among the results");
    panels.push_back(value->second);
  }
  for (const auto& [name, member] : kPanelColumns) {
    RAYFIELD_ASSIGN(const auto column, arrays.column<double>(name));
    if (column.size() != panels.size()) return damaged("columns differ in length");
    for (std::size_t i = 0; i < panels.size(); ++i) panels[i]->*member = column[i];
  }
  RAYFIELD_ASSIGN(const auto metres, arrays.column<double>("metre_leaf_area_per_m"));
  if (metres.size() != results.row_metres.size()) return damaged("not as many half metres as results");
  for (std::size_t i = 0; i < metres.size(); ++i) results.row_metres[i].leaf_area_per_m = metres[i];
  RAYFIELD_CHECK(take_descriptors(kLeafDescriptors, "panel_", arrays, panels.size(),
                                  [&](std::size_t i) -> PanelValue& { return *panels[i]; }));
  RAYFIELD_CHECK(take_descriptors(kLeafDescriptors, "metre_", arrays, results.row_metres.size(),
                                  [&](std::size_t i) -> RowMetreProduct& { return results.row_metres[i]; }));
  RAYFIELD_CHECK(take_profile(arrays, results));
  const char* from = source.scan_id.empty() ? kWoodFromEstimate : kWoodFromDormantScan;
  for (PanelValue* value : panels) value->wood_scan_id = source.scan_id, value->wood_from = from;
  results.scan.wood_scan_id = source.scan_id, results.scan.wood_from = from;
  return {};
}

Result<WoodSource> wood_source_of(const tile::ArraySet& arrays) {
  if (arrays.kind != kKind || arrays.version != kVersion) return damaged("not leaf areas of version 1");
  try {
    const json attributes = json::parse(arrays.attributes);
    return WoodSource{attributes.at("wood_scan_id").get<std::string>(),
                      attributes.at("wood_content").get<std::string>()};
  } catch (const json::exception& e) {
    return damaged(e.what());
  }
}

}  // namespace rayfield::density
