#pragma once

#include <string>

#include "formats/geopackage/gpkg_layers.h"
#include "rayfield/formats/geopackage.h"

/// Projects of QGIS inside a GeoPackage, in the table that QGIS 3 keeps them in.
namespace rayfield::formats::gpkg {

inline constexpr const char* kProjectTable = "qgis_projects";
/// SQL that makes the table, as QGIS has it. It is no layer and stands in none of GeoPackage's own tables, in files
/// that QGIS has written neither.
inline constexpr const char* kCreateProjectTable =
    "CREATE TABLE IF NOT EXISTS qgis_projects (name TEXT PRIMARY KEY, metadata BLOB, content BLOB)";
/// SQL condition on a row: it was saved by somebody else than rayfield, be it under the name of rayfield's project.
inline constexpr const char* kProjectOfUsers =
    "ifnull(instr(CAST(metadata AS TEXT), '\"last_modified_user\": \"rayfield\"'), 0) = 0";

/// The name of a block's project: the block's, with letters, digits, blanks, '-', '_' and '.'. QGIS 3.22 keeps projects
/// of other names (with '%', '&', '#'), but cannot open them again.
std::string project_name(const std::string& block);

/// Writes the project of a block under that name. `time`: of change, as the whole file has it.
Result<void> add_project(const OpenGeoPackage& package, const BlockProducts& block, const GeoPackageOptions& options,
                         const std::string& time);

}  // namespace rayfield::formats::gpkg
