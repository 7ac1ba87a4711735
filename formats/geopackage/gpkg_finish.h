#pragma once

#include <string>

#include "formats/geopackage/gpkg_layers.h"
#include "rayfield/formats/geopackage.h"

namespace rayfield::formats::gpkg {

/// Adds to the filled tables what SQL must say: column descriptions (schema extension), indices, the view
/// `panel_by_date`, `layer_styles`, the project, and what gpkg_own.h records. `time`: the time of change that the file
/// records.
Result<void> finish(const OpenGeoPackage& package, const BlockProducts& block, const GeoPackageOptions& options,
                    const std::string& time);

/// Integrity and numbers of rows of the finished file.
Result<void> check_file(GdalSession& gdal, const std::string& path, const BlockProducts& block,
                        const std::string& target);

}  // namespace rayfield::formats::gpkg
