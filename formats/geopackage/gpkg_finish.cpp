#include "formats/geopackage/gpkg_finish.h"

#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include <array>

#include "formats/geopackage/gpkg_describe.h"
#include "formats/geopackage/gpkg_own.h"
#include "formats/geopackage/gpkg_project.h"
#include "formats/gis/block_styles.h"
#include "formats/io/text_escape.h"

namespace rayfield::formats::gpkg {
namespace {

/// The description of every column.
Result<void> describe_columns(const OpenGeoPackage& package, const BlockProducts& block) {
  const std::array<Table, 10> tables = {
      vine_row_table(),  panel_table(),           post_table(),         scan_table(),  panel_value_table(),
      row_metre_table(), panel_wide_table(block), panel_by_date_view(), block_table(), panel_profile_table()};
  return describe_tables(package, tables);
}

/// GDAL and QGIS take a view for a layer once it has a unique integer first column named OGC_FID and is registered.
Result<void> create_view(const OpenGeoPackage& package, const std::string& time) {
  const Table view = panel_by_date_view();
  const Table panel = panel_table();
  std::string columns;
  for (const Column& column : view.columns) {
    bool of_panel = false;
    for (const Column& own : panel.columns) of_panel = of_panel || own.name == column.name;
    columns += fmt::format(", {}.{} AS {}", of_panel ? "p" : "v", column.name, column.name);
  }
  RAYFIELD_CHECK(execute(package, fmt::format("CREATE VIEW panel_by_date AS SELECT v.fid AS OGC_FID, p.geom AS geom{} "
                                              "FROM panel_value AS v JOIN panel AS p ON p.panel_uid = v.panel_uid",
                                              columns)));
  RAYFIELD_CHECK(execute(
      package, fmt::format("INSERT INTO gpkg_contents (table_name, data_type, identifier, description, last_change, "
                           "min_x, min_y, max_x, max_y, srs_id) SELECT {0}, 'features', {0}, {1}, {2}, "
                           "min_x, min_y, max_x, max_y, srs_id FROM gpkg_contents WHERE table_name = 'panel'",
                           sql_literal(view.name), sql_literal(view.description), sql_literal(time))));
  return execute(package,
                 "INSERT INTO gpkg_geometry_columns (table_name, column_name, geometry_type_name, srs_id, z, m) "
                 "SELECT 'panel_by_date', 'geom', 'POLYGON', srs_id, 0, 0 FROM gpkg_geometry_columns "
                 "WHERE table_name = 'panel'");
}

/// The default of every layer, and a second style where there are values.
std::vector<Style> styles(const BlockProducts& block, const ColorScale& scale) {
  std::vector<Style> all = {{"vine_row", "rows", qml::document(row_style())},
                            {"panel", "outlines", qml::document(panel_style())},
                            {"post", "posts", qml::document(post_style())}};
  for (const auto& [table, points] : {std::pair{"row_metre", true}, std::pair{"panel_by_date", false}}) {
    all.push_back({table, kLeafAreaWords, qml::document(panel_value_style(scale, points, "scan_date"))});
    all.push_back({table, kRelativeStyle, qml::document(panel_relative_style(points, "scan_date")), false});
  }
  if (!block.scans.empty()) {
    const std::string column = wide_column(block, block.scans.size() - 1);
    all.push_back({"panel_wide", column, qml::document(qml::graduated_style({column, scale}))});
  }
  return all;
}

}  // namespace

Result<void> finish(const OpenGeoPackage& package, const BlockProducts& block, const GeoPackageOptions& options,
                    const std::string& time) {
  RAYFIELD_CHECK(execute(package, "CREATE INDEX idx_panel_value_panel ON panel_value (panel_uid, scan_date)"));
  RAYFIELD_CHECK(execute(package, "CREATE INDEX idx_panel_profile_panel ON panel_profile (panel_uid, scan_date)"));
  RAYFIELD_CHECK(execute(package, "CREATE INDEX idx_row_metre_row ON row_metre (row_number, scan_date)"));
  RAYFIELD_CHECK(create_view(package, time));
  RAYFIELD_CHECK(describe_columns(package, block));
  RAYFIELD_CHECK(add_layer_styles(package, styles(block, options.panel_scale), time));
  if (options.project) RAYFIELD_CHECK(add_project(package, block, options, time));
  return add_metadata(package, block);
}

Result<void> check_file(GdalSession& gdal, const std::string& path, const BlockProducts& block,
                        const std::string& target) {
  DatasetPtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  if (dataset == nullptr) return gdal.failure(kWhat, target);
  const auto value = [&dataset](const std::string& sql) {
    OGRLayer* rows = dataset->ExecuteSQL(sql.c_str(), nullptr, nullptr);
    if (rows == nullptr) return std::string();
    OGRFeature* row = rows->GetNextFeature();
    std::string text = row == nullptr ? "" : row->GetFieldAsString(0);
    OGRFeature::DestroyFeature(row);
    dataset->ReleaseResultSet(rows);
    return text;
  };
  std::size_t values = 0, metres = 0, bands = 0;
  for (const ScanResults& scan : block.scans)
    values += scan.panel_values.size(), metres += scan.row_metres.size(), bands += scan.profile.size();
  const std::array<std::pair<const char*, std::size_t>, 8> expected = {{{"vine_row", block.rows.size()},
                                                                        {"panel", block.panels.size()},
                                                                        {"post", block.posts.size()},
                                                                        {"scan", block.scans.size()},
                                                                        {"panel_value", values},
                                                                        {"row_metre", metres},
                                                                        {"panel_profile", bands},
                                                                        {"panel_wide", block.panels.size()}}};
  bool good = value("PRAGMA integrity_check") == "ok";
  for (const auto& [table, count] : expected) {
    good = good && value(fmt::format("SELECT count(*) FROM {}", table)) == std::to_string(count);
  }
  if (good && !gdal.failed()) return {};
  if (gdal.failed()) return gdal.failure(kWhat, target);
  return fail(ErrorCode::resources, kWhat, target, "the file reads back other rows than were written",
              "check the disk");
}

}  // namespace rayfield::formats::gpkg
