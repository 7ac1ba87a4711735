#pragma once

#include <string>

#include "rayfield/formats/style.h"

/// What the QGIS project inside a GeoPackage shows beside the GeoPackage's own layers (docs/qgis.md).
namespace rayfield::formats {

/// A map of one scan that lies beside a GeoPackage.
struct ProjectMap {
  std::string scan_id, product, unit;  ///< product: "plan_density", see RasterProduct
  std::string file_name;               ///< in the GeoPackage's folder
  ColorScale scale;
};

}  // namespace rayfield::formats
