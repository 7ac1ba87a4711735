#pragma once

#include <functional>
#include <span>
#include <string>

#include "formats/geopackage/gpkg_layers.h"

namespace rayfield::formats::gpkg {

/// The time of change that a file records: the end of the last scan, so that equal products are equal bytes.
std::string time_of_change(std::span<const ScanProduct> scans);

/// What a GeoPackage is made of.
struct FileContent {
  std::string crs, time;  ///< code or WKT; time of change
  std::function<Result<void>(const OpenGeoPackage&)> fill;
  /// In a second session, because GDAL writes extents and spatial indices when it closes the first.
  std::function<Result<void>(const OpenGeoPackage&)> finish;
  /// Of the file at a path, before it is renamed into place.
  std::function<Result<void>(GdalSession&, const std::string&)> check;
};

/// Writes a GeoPackage 1.2 that appears whole or not at all. Errors: usage (CRS), internal, resources, bad_input.
Result<void> write_file(const FileContent& content, const std::string& path);

}  // namespace rayfield::formats::gpkg
