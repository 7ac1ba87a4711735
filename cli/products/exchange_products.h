#pragma once

#include <string>
#include <vector>

#include "cli/products/export_block.h"
#include "cli/products/export_folder.h"
#include "rayfield/core/products.h"

namespace rayfield::cli {

/// Formats of `rayfield export` as --format takes them, and farm systems as --profile does.
std::vector<std::string> export_formats();
std::vector<std::string> profile_names();

/// Checks that what is asked for can be written here. Errors: usage (GDAL without a driver, no such profile).
Result<void> check_exchange(const ExportOptions& options);

/// Panels and half metres for other software: CSV, GeoJSON, KML, FlatGeobuf, GeoParquet and shapefiles, as far as they
/// are asked for. `content` names what they are made of. Errors: those of the writers.
Result<void> export_exchange(const BlockProducts& block, const std::string& content, const ExportOptions& options,
                             ExportFolder& folder);

}  // namespace rayfield::cli
