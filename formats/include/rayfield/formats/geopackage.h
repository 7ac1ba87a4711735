#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/qgis_project.h"
#include "rayfield/formats/style.h"

/// geopackage: a block with all its dates as one GeoPackage 1.2 file, ready for QGIS. The tables and columns are listed
/// with their units in docs/products.md and, inside the file, in `gpkg_data_columns`.
namespace rayfield::formats {

struct GeoPackageOptions {
  /// Of the leaf area per metre of row, m²/m; one for all dates.
  ColorScale panel_scale{0, 6, Ramp::canopy};
  /// Writes a QGIS project into the file, named after the block (docs/qgis.md). It names the GeoPackage by its file
  /// name, so the file cannot be renamed without it.
  bool project = false;
  std::vector<ProjectMap> maps;  ///< that the project shows
};

/// Writes the layers
///   vine_row, panel, post                     what stands in the block (line, polygon, point)
///   scan, panel_value                         dates, and one line per panel and date (tables without geometry)
///   row_metre                                 points every half metre of row and date
///   panel_by_date                             spatial view: panel outlines with the values of each date
///   panel_wide                                panel outlines with one column per date
///   layer_styles                              QGIS styles: on one scale for all dates, and relative to a date's mean
///   qgis_projects                             the project, if asked for
/// with spatial indices. NaN becomes NULL. Equal input gives equal bytes: the time of change recorded in the file is
/// the end of the block's last scan. The file appears whole or not at all; it is checked (integrity, number of rows)
/// before it is renamed into place. Errors: usage (CRS, an invalid date), internal (coordinates that are not
/// finite, two panels with one UUID, GDAL), resources (disk, memory, permission), bad_input (no such folder).
Result<void> write_geopackage(const BlockProducts& block, const std::string& path,
                              const GeoPackageOptions& options = {});

/// What an existing GeoPackage holds.
struct ExistingGeoPackage {
  std::vector<std::string> scan_ids;  ///< in the order of their dates
  bool has_additions = false;         ///< tables, views, layer styles or projects of users, which carry_over() copies
  /// What carry_over() does not copy, in words: columns that users added to rayfield's tables; a whole file that is not
  /// a GeoPackage of rayfield's. Values that were changed in rayfield's own tables are not noticed.
  std::vector<std::string> lost;
};

/// Nothing if there is no such file.
Result<std::optional<ExistingGeoPackage>> inspect_geopackage(const std::string& path);

/// Errors: usage, where another program has the file open for writing. Its journal lies beside the file then, and
/// SQLite would play it back into whatever replaces the file.
Result<void> check_not_in_use(const std::string& path);

/// Whether write_geopackage() and carry_over() can replace `path` so that nothing is lost. A scan that the file holds
/// and `block` leaves out is lost if it is one of `scans_of_store`; others have been removed from the store. Errors:
/// usage, naming the scans, or what users added; those of check_not_in_use().
Result<void> check_replaceable(const BlockProducts& block, const std::vector<std::string>& scans_of_store,
                               const std::string& path);

/// Copies what users added to a GeoPackage (tables with geometries and spatial indices, views, layer styles, QGIS
/// projects) into one that was just written. A style of theirs that was the default of its layer stays it. Our own
/// project is not carried over; one that users saved under its name gets a name of its own, which says when. Errors:
/// resources, internal.
Result<void> carry_over(const std::string& from, const std::string& to);

}  // namespace rayfield::formats
