#include "rayfield/formats/season_tables.h"

#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include <array>
#include <map>

#include "formats/geopackage/gpkg_describe.h"
#include "formats/geopackage/gpkg_file.h"
#include "formats/geopackage/gpkg_row.h"
#include "formats/gis/qml.h"
#include "formats/io/guard.h"
#include "formats/io/staged_output.h"
#include "formats/io/text_escape.h"
#include "rayfield/core/date.h"

namespace rayfield::formats {
namespace {

using gpkg::kWhat;

constexpr std::string_view kCsvWhat = "cannot write CSV";

/// A number of a panel's change, in the order of the layer and the CSV.
struct ChangeColumn {
  const char* name;
  double (*value)(const PanelChange&);
  const char* description;
};
constexpr std::array<ChangeColumn, 12> kColumns = {{
    {"leaf_area_a_m2", [](const PanelChange& p) { return p.a.leaf_area_m2; }, "one-sided leaf area on date a, m²"},
    {"leaf_area_b_m2", [](const PanelChange& p) { return p.b.leaf_area_m2; }, "one-sided leaf area on date b, m²"},
    {"leaf_change_m2", [](const PanelChange& p) { return p.leaf_change_m2; }, "change of the leaf area, b − a, m²"},
    {"leaf_change_per_m", [](const PanelChange& p) { return p.leaf_change_per_m; },
     "change of the leaf area per metre of row, m²/m"},
    {"leaf_change_percent", [](const PanelChange& p) { return p.leaf_change_percent; },
     "change of the leaf area in per cent of date a"},
    {"se_change_m2", [](const PanelChange& p) { return p.se_change_m2; }, "standard error of leaf_change_m2, m²"},
    {"ci_low_m2", [](const PanelChange& p) { return p.ci_low_m2; },
     "lower end of the 95 % interval of leaf_change_m2, m²"},
    {"ci_high_m2", [](const PanelChange& p) { return p.ci_high_m2; },
     "upper end of the 95 % interval of leaf_change_m2, m²"},
    {"p_value", [](const PanelChange& p) { return p.p_value; },
     "how likely a change as large is if nothing changed, 0 … 1"},
    {"plant_area_a_m2", [](const PanelChange& p) { return p.a.plant_area_m2; },
     "one-sided plant area (leaves, wood, posts, wires) on date a, m²"},
    {"plant_area_b_m2", [](const PanelChange& p) { return p.b.plant_area_m2; },
     "one-sided plant area (leaves, wood, posts, wires) on date b, m²"},
    {"plant_change_m2", [](const PanelChange& p) { return p.plant_change_m2; },
     "change of the plant area, b − a, m²; its standard error is that of leaf_change_m2"},
}};

gpkg::Table change_table() {
  gpkg::Table table{
      "panel_change",
      "Panels with what changed between two dates",
      wkbPolygon,
      {{"panel_uid", OFTString, "UUID of the panel, the same on all dates"},
       {"row_number", OFTInteger, "number of the row in the block, from 1"},
       {"panel_number", OFTInteger, "number of the panel along its row, from 1"},
       {"length_m", OFTReal, "length of the panel along the row, m"},
       {"scan_a", OFTString, "identifier of the earlier scan (as asked for)"},
       {"date_a", OFTDate, "its local date"},
       {"scan_b", OFTString, "identifier of the later scan (as asked for)"},
       {"date_b", OFTDate, "its local date"},
       {"significance", OFTString,
        "gain or loss where the 95 % interval of the change leaves out 0, none where it holds 0, not_seen "
        "where the panel was not seen on one of the dates"}}};
  for (const ChangeColumn& column : kColumns) table.columns.push_back({column.name, OFTReal, column.description});
  return table;
}

Result<void> fill_changes(const gpkg::OpenGeoPackage& package, const BlockProducts& block, const DateComparison& c) {
  RAYFIELD_ASSIGN(OGRLayer * layer, gpkg::create_table(package, change_table()));
  std::map<std::string, const PanelProduct*> outlines;
  for (const PanelProduct& panel : block.panels) outlines[panel.panel_uid] = &panel;
  for (const PanelChange& panel : c.panels) {
    gpkg::Row out(*layer);
    out.text(panel.panel_uid).integer(panel.row_number).integer(panel.panel_number).real(panel.length_m);
    out.text(c.a.scan_id).date(c.a.scan_date).text(c.b.scan_id).date(c.b.scan_date);
    out.text(std::string(verdict_text(panel.verdict)));
    for (const ChangeColumn& column : kColumns) out.real(column.value(panel));
    const auto found = outlines.find(panel.panel_uid);
    if (found != outlines.end()) RAYFIELD_CHECK(gpkg::set_outline(package, *found->second, out));
    RAYFIELD_CHECK(gpkg::check_written(package, out.write()));
  }
  return {};
}

Result<void> finish_changes(const gpkg::OpenGeoPackage& package, const std::string& time) {
  const std::array<gpkg::Table, 1> tables = {change_table()};
  RAYFIELD_CHECK(gpkg::describe_tables(package, tables));
  const std::string column = "leaf_change_per_m", label = "change of the leaf area per metre of row, m²/m";
  const ColorScale scale = product_scale(column, 0, 0);
  const std::array<gpkg::Style, 1> styles = {
      {{"panel_change", label, qml::document(qml::graduated_style({column, scale}))}}};
  return gpkg::add_layer_styles(package, styles, time);
}

Result<void> check_changes(GdalSession& gdal, const std::string& file, std::size_t panels, const std::string& target) {
  DatasetPtr dataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  OGRLayer* layer = dataset == nullptr ? nullptr : dataset->GetLayerByName("panel_change");
  const bool good = layer != nullptr && layer->GetFeatureCount() == static_cast<GIntBig>(panels);
  if (gdal.failed()) return gdal.failure(kWhat, target);
  if (good) return {};
  return fail(ErrorCode::resources, kWhat, target, "the file reads back other rows than were written",
              "check the disk");
}

std::string change_csv(const DateComparison& c) {
  std::string text = "panel_uid,row_number,panel_number,length_m,scan_a,date_a,scan_b,date_b,significance";
  for (const ChangeColumn& column : kColumns) text += fmt::format(",{}", column.name);
  text += "\n";
  for (const PanelChange& panel : c.panels) {
    text += fmt::format("{},{},{},{},{},{},{},{},{}", csv_escape(panel.panel_uid), panel.row_number, panel.panel_number,
                        number_text(panel.length_m, ""), csv_escape(c.a.scan_id), csv_escape(c.a.scan_date),
                        csv_escape(c.b.scan_id), csv_escape(c.b.scan_date), verdict_text(panel.verdict));
    for (const ChangeColumn& column : kColumns) text.append(",").append(number_text(column.value(panel), ""));
    text += "\n";
  }
  return text;
}

std::string season_csv(std::span<const SeasonValue> values) {
  std::string text =
      "row_number,scan_id,scan_date,panels,panels_seen,length_m,leaf_area_m2,leaf_area_per_m,ci_low_per_m,"
      "ci_high_per_m,plant_area_m2,plant_area_per_m\n";
  for (const SeasonValue& v : values) {
    text += fmt::format("{},{},{},{},{}", v.row_number == 0 ? "" : std::to_string(v.row_number), csv_escape(v.scan_id),
                        csv_escape(v.scan_date), v.panels, v.panels_seen);
    for (const double number : {v.length_m, v.leaf_area_m2, v.leaf_area_per_m, v.ci_low_per_m, v.ci_high_per_m,
                                v.plant_area_m2, v.plant_area_per_m})
      text.append(",").append(number_text(number, ""));
    text += "\n";
  }
  return text;
}

}  // namespace

Result<void> write_change_geopackage(const BlockProducts& block, const DateComparison& comparison,
                                     const std::string& path) {
  return guarded(kWhat, path, [&]() -> Result<void> {
    const std::array<ScanProduct, 2> scans = {comparison.a, comparison.b};
    for (const ScanProduct& scan : scans) RAYFIELD_CHECK(parse_date(scan.scan_date));
    const std::string time = gpkg::time_of_change(scans);
    return gpkg::write_file(
        {block.crs, time, [&](const gpkg::OpenGeoPackage& package) { return fill_changes(package, block, comparison); },
         [&](const gpkg::OpenGeoPackage& package) { return finish_changes(package, time); },
         [&](GdalSession& gdal, const std::string& file) {
           return check_changes(gdal, file, comparison.panels.size(), path);
         }},
        path);
  });
}

Result<void> write_change_csv(const DateComparison& comparison, const std::string& path) {
  return guarded(kCsvWhat, path, [&] { return write_file_atomically(path, change_csv(comparison), kCsvWhat); });
}

Result<void> write_season_csv(std::span<const SeasonValue> values, const std::string& path) {
  return guarded(kCsvWhat, path, [&] { return write_file_atomically(path, season_csv(values), kCsvWhat); });
}

}  // namespace rayfield::formats
