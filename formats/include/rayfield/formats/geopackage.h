#pragma once

#include <string>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"

/// A block with all its dates as one GeoPackage 1.2 file, ready for QGIS. The tables and columns are listed with their
/// units in docs/products.md and, inside the file, in `gpkg_data_columns`.
namespace rayfield::formats {

/// Writes the layers
///   vine_row, panel, post                     what stands in the block (line, polygon, point)
///   scan, panel_value                         dates, and one line per panel and date (tables without geometry)
///   row_metre                                 points every half metre of row and date
///   panel_by_date                             spatial view: panel outlines with the values of each date
///   panel_wide                                panel outlines with one column per date
///   layer_styles                              default QGIS styles on fixed colour scales
/// with spatial indices. NaN becomes NULL. Equal input gives equal bytes: the time of change recorded in the file is
/// the end of the block's last scan. The file appears whole or not at all; it is checked (integrity, number of rows)
/// before it is renamed into place. Errors: usage (CRS, a date that is none), internal (coordinates that are not
/// finite, two panels with one UUID, GDAL), resources (disk, memory, permission), bad_input (no such folder).
Result<void> write_geopackage(const BlockProducts& block, const std::string& path);

}  // namespace rayfield::formats
