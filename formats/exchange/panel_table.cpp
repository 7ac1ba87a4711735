#include "formats/exchange/panel_table.h"

#include <fmt/format.h>

#include <map>

#include "formats/gis/descriptor_columns.h"
#include "formats/gis/measured_columns.h"
#include "formats/gis/to_wgs84.h"
#include "formats/io/text_escape.h"
#include "formats/picture/color.h"

namespace rayfield::formats {
namespace {

VectorValue text_or_null(const std::string& text) { return text.empty() ? VectorValue() : VectorValue(text); }

std::vector<VectorValue> values_of(const BlockProducts& block, const PanelProduct& panel, const PanelValue* value) {
  std::vector<VectorValue> values = {
      panel.panel_uid, std::int64_t{panel.row_number}, std::int64_t{panel.panel_number}, panel.length_m,
      block.block,     text_or_null(block.farm),       text_or_null(block.variety),      text_or_null(panel.row_name)};
  if (value == nullptr) return values;
  values.insert(values.end(), {value->scan_id, value->scan_date});
  for (const MeasuredColumn& column : kMeasuredColumns) values.emplace_back(value->*column.value);
  values.insert(values.end(), {value->ray_count, text_or_null(value->wood_scan_id)});
  for (const DescriptorColumn& column : kDescriptorColumns) values.emplace_back(value->descriptors.*column.value);
  values.push_back(text_or_null(value->wood_from));
  return values;
}

}  // namespace

std::vector<VectorColumn> panel_columns() {
  std::vector<VectorColumn> columns = {
      {"panel_uid", "panel_uid", OFTString, "", "UUID of the panel, the same on all dates"},
      {"row_number", "row_no", OFTInteger, "", "number of the row in the block: the farm's own where it gave one"},
      {"panel_number", "panel_no", OFTInteger, "", "number of the panel along its row, from 1"},
      {"length_m", "length_m", OFTReal, "m", "length of the panel along the row"},
      {"block", "block", OFTString, "", "name of the block"},
      {"farm", "farm", OFTString, "", "name of the farm"},
      {"variety", "variety", OFTString, "", "variety that is grown"},
      {"row_name", "row_name", OFTString, "", "the farm's name of the row"},
      {"scan_id", "scan_id", OFTString, "", "identifier of the scan"},
      {"scan_date", "scan_date", OFTDate, "", "local date of the scan"}};
  for (const MeasuredColumn& column : kMeasuredColumns)
    columns.push_back({column.name, column.short_name, OFTReal, column.unit, column.description});
  columns.push_back({"ray_count", "ray_count", OFTInteger64, "", "rays through the panel"});
  columns.push_back({"wood_scan_id", "wood_scan", OFTString, "", kWoodScanDescription});
  for (const DescriptorColumn& column : kDescriptorColumns)
    columns.push_back({column.name, column.short_name, OFTReal, column.unit, column.description});
  columns.push_back({"wood_from", "wood_from", OFTString, "", kWoodFromDescription});
  return columns;
}

Result<VectorTable> panel_table(const BlockProducts& block, std::size_t scan_index, std::string_view what,
                                const std::string& where) {
  if (scan_index >= block.scans.size())
    return fail(ErrorCode::usage, what, where,
                fmt::format("scan {} of {} was asked for", scan_index + 1, block.scans.size()));
  RAYFIELD_ASSIGN(const ToWgs84 to_wgs84, ToWgs84::create(block.crs, what, where));
  std::map<std::string, const PanelValue*> by_panel;
  for (const PanelValue& value : block.scans[scan_index].panel_values) by_panel[value.panel_uid] = &value;
  const ColorScale scale = product_scale("leaf_area_per_m", 0, 0);
  VectorTable table{"panels", wkbPolygon, panel_columns(), {}};
  for (const PanelProduct& panel : block.panels) {
    const std::string label = fmt::format("row {}, panel {}", panel.row_number, panel.panel_number);
    auto outline = valid_polygon(ring_polygon(panel.outline));
    RAYFIELD_CHECK(to_wgs84.move(*outline, label));
    const auto found = by_panel.find(panel.panel_uid);
    const PanelValue* value = found == by_panel.end() ? nullptr : found->second;
    table.features.push_back({label, std::move(outline), values_of(block, panel, value)});
    if (value != nullptr) {
      const Rgba color = color_at(scale, value->leaf_area_per_m);
      if (color.a > 0) table.features.back().fill = hex_text(color);
    }
  }
  return table;
}

VectorTable reduced_for(VectorTable table, const FarmProfile& profile) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    if (!profile.numbers_only || table.columns[i].is_number()) kept.push_back(i);
  if (profile.most_columns > 0 && kept.size() > profile.most_columns) kept.resize(profile.most_columns);
  VectorTable out{table.name, table.geometry, {}, {}};
  for (const std::size_t i : kept) out.columns.push_back(table.columns[i]);
  for (VectorFeature& feature : table.features) {
    std::vector<VectorValue> values;
    for (const std::size_t i : kept) values.push_back(std::move(feature.values[i]));
    out.features.push_back({feature.label, std::move(feature.geometry), std::move(values), feature.fill});
  }
  return out;
}

std::string field_dictionary(const std::vector<VectorColumn>& columns) {
  std::string text = "name,column,unit,meaning\n";
  for (const VectorColumn& column : columns)
    text += fmt::format("{},{},{},{}\n", csv_escape(column.name), csv_escape(column.short_name),
                        csv_escape(column.unit), csv_escape(column.meaning));
  return text;
}

}  // namespace rayfield::formats
