#pragma once

#include <span>
#include <string>

#include "formats/geopackage/gpkg_layers.h"

namespace rayfield::formats::gpkg {

/// Runs a statement that returns no rows. Errors: GDAL's.
Result<void> execute(const OpenGeoPackage& package, const std::string& sql);

/// The schema extension (GeoPackage 1.2, annex F.9) and the description of every column of the tables.
Result<void> describe_tables(const OpenGeoPackage& package, std::span<const Table> tables);

/// How QGIS shows a layer, by default or when chosen.
struct Style {
  std::string table, name, qml;
  bool is_default = true;
};

/// The table that QGIS looks in for default styles; its column names and widths are QGIS's own. `time`: of the last
/// change.
Result<void> add_layer_styles(const OpenGeoPackage& package, std::span<const Style> styles, const std::string& time);

}  // namespace rayfield::formats::gpkg
