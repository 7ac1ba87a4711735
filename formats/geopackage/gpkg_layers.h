#pragma once

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <string>

#include "formats/geopackage/gpkg_schema.h"
#include "formats/gis/gdal_session.h"
#include "rayfield/core/products.h"

namespace rayfield::formats::gpkg {

/// A GeoPackage being filled.
struct OpenGeoPackage {
  GDALDataset& dataset;
  GdalSession& gdal;
  OGRSpatialReference& crs;
  const std::string& target;  ///< path for messages
};

/// Creates and fills all real tables (the view and the styles come after, see gpkg_finish.h).
Result<void> fill_tables(const OpenGeoPackage& package, const BlockProducts& block);

/// Creates an empty table with the columns of `table`. `fid`: name of the primary key.
Result<OGRLayer*> create_table(const OpenGeoPackage& package, const Table& table, const char* fid = "fid");

}  // namespace rayfield::formats::gpkg
