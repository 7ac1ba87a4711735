#include "formats/geopackage/gpkg_describe.h"

#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include "formats/io/text_escape.h"

namespace rayfield::formats::gpkg {

Result<void> execute(const OpenGeoPackage& package, const std::string& sql) {
  OGRLayer* rows = package.dataset.ExecuteSQL(sql.c_str(), nullptr, nullptr);
  if (rows != nullptr) package.dataset.ReleaseResultSet(rows);
  if (package.gdal.failed()) return package.gdal.failure(kWhat, package.target);
  return {};
}

Result<void> describe_tables(const OpenGeoPackage& package, std::span<const Table> tables) {
  RAYFIELD_CHECK(execute(package,
                         "CREATE TABLE gpkg_data_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL, "
                         "name TEXT, title TEXT, description TEXT, mime_type TEXT, constraint_name TEXT, "
                         "CONSTRAINT pk_gdc PRIMARY KEY (table_name, column_name), "
                         "CONSTRAINT gdc_tn UNIQUE (table_name, name))"));
  RAYFIELD_CHECK(execute(package,
                         "CREATE TABLE gpkg_data_column_constraints (constraint_name TEXT NOT NULL, "
                         "constraint_type TEXT NOT NULL, value TEXT, min NUMERIC, min_is_inclusive BOOLEAN, "
                         "max NUMERIC, max_is_inclusive BOOLEAN, description TEXT, "
                         "CONSTRAINT gdcc_ntv UNIQUE (constraint_name, constraint_type, value))"));
  for (const char* table : {"gpkg_data_columns", "gpkg_data_column_constraints"}) {
    RAYFIELD_CHECK(execute(
        package, fmt::format("INSERT INTO gpkg_extensions (table_name, column_name, extension_name, definition, scope) "
                             "VALUES ('{}', NULL, 'gpkg_schema', "
                             "'http://www.geopackage.org/spec121/#extension_schema', 'read-write')",
                             table)));
  }
  for (const Table& table : tables) {
    for (const Column& column : table.columns) {
      RAYFIELD_CHECK(execute(
          package,
          fmt::format("INSERT INTO gpkg_data_columns (table_name, column_name, description) VALUES ({}, {}, {})",
                      sql_literal(table.name), sql_literal(column.name), sql_literal(column.description))));
    }
  }
  return {};
}

Result<void> add_layer_styles(const OpenGeoPackage& package, std::span<const Style> styles, const std::string& time) {
  const Table table{"layer_styles",
                    "Styles of the layers (QGIS)",
                    wkbNone,
                    {{"f_table_catalog", OFTString, {}},
                     {"f_table_schema", OFTString, {}},
                     {"f_table_name", OFTString, {}},
                     {"f_geometry_column", OFTString, {}},
                     {"styleName", OFTString, {}},
                     {"styleQML", OFTString, {}},
                     {"styleSLD", OFTString, {}},
                     {"useAsDefault", OFTInteger, {}},
                     {"description", OFTString, {}},
                     {"owner", OFTString, {}},
                     {"ui", OFTString, {}},
                     {"update_time", OFTDateTime, {}}}};
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(package, table, "id"));
  OGRField changed;
  const bool has_time = OGRParseDate(time.c_str(), &changed, 0);
  changed.Date.TZFlag = 100;
  for (const Style& style : styles) {
    OGRFeature row(layer->GetLayerDefn());
    row.SetField("f_table_catalog", "");
    row.SetField("f_table_schema", "");
    row.SetField("f_table_name", style.table.c_str());
    row.SetField("f_geometry_column", "geom");
    row.SetField("styleName", style.name.c_str());
    row.SetField("styleQML", style.qml.c_str());
    row.SetField("styleSLD", "");
    row.SetField("useAsDefault", style.is_default ? 1 : 0);
    row.SetField("description", style.name.c_str());
    row.SetField("owner", "rayfield");
    if (has_time) row.SetField(row.GetFieldIndex("update_time"), &changed);
    if (layer->CreateFeature(&row) != OGRERR_NONE) return package.gdal.failure(kWhat, package.target);
  }
  return {};
}

}  // namespace rayfield::formats::gpkg
