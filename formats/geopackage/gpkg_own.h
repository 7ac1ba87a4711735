#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/geopackage/gpkg_layers.h"

/// Which parts of a GeoPackage are rayfield's own, to distinguish them from what users added.
namespace rayfield::formats::gpkg {

/// What somebody else put into a GeoPackage of ours, by name.
struct Additions {
  std::vector<std::string> tables, views;
  std::vector<std::string> styles;    ///< of layer_styles
  std::vector<std::string> projects;  ///< of qgis_projects
  std::vector<std::string> columns;   ///< of our own tables, in words
};
/// Nothing where the file is none of ours.
std::optional<Additions> additions_in(GDALDataset& dataset);

/// Values of the first column of every row; empty where the query fails.
std::vector<std::string> query(GDALDataset& dataset, const std::string& sql);

/// Records in the finished file, as metadata of the data set, the store's snapshot (`snapshot`) and every table and
/// column that was written (`rayfield_tables`).
Result<void> add_metadata(const OpenGeoPackage& package, const BlockProducts& block);

}  // namespace rayfield::formats::gpkg
