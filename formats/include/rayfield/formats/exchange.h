#pragma once

#include <cstddef>
#include <string>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/farm_profile.h"

/// exchange: panels for other software, and surveys from it. Files appear whole or not at all; equal input gives equal
/// bytes. Columns are those of `panel_by_date` with `block`, `farm`, `variety` and `row_name`.
namespace rayfield::formats {

/// Formats that hold the panels of one scan as polygons in longitude and latitude (WGS 84).
enum class PanelFormat { geojson, kml, flatgeobuf, geoparquet };

/// Errors: usage, where the GDAL that rayfield runs with cannot write it.
Result<void> check_panel_format(PanelFormat format, const std::string& path);

/// The panels of one scan. A panel without a value on that scan has only its own columns. GeoJSON follows RFC 7946: 9
/// decimals, outer rings counter-clockwise, NaN as null, and the member `snapshot`.
/// Errors: usage (CRS, `scan_index` beyond the scans, GDAL without the driver), internal (coordinates), resources,
/// bad_input (no such folder).
Result<void> write_panels(const BlockProducts& block, std::size_t scan_index, PanelFormat format,
                          const std::string& path);

/// The panels of one scan as zipped shapefile after the rules of a farm system, columns with their short names.
/// Errors: as write_panels(); usage where the system does not take so many panels.
Result<void> write_panels_shapefile(const BlockProducts& block, std::size_t scan_index, const FarmProfile& profile,
                                    const std::string& path);

/// What the columns of these files mean: CSV with name, short name (of shapefiles), unit and meaning.
/// Errors: resources, bad_input (no such folder).
Result<void> write_panel_fields(const std::string& path);

/// All panels on all dates, one line each, with a header line (RFC 4180, UTF-8, decimal points, ISO dates, LF). Columns
/// as in `panel_by_date`, then block, farm, variety and the panel's centre (longitude, latitude); NaN is an empty
/// field. Errors: usage (CRS), internal (coordinates), resources, bad_input (no such folder).
Result<void> write_panels_csv(const BlockProducts& block, const std::string& path);

/// All half metres of row on all dates: row_number, chainage_m, easting_m, northing_m, scan_id, scan_date,
/// leaf_area_per_m, plant_area_per_m, canopy_height_m, canopy_width_m, canopy descriptors, block, farm, variety,
/// longitude, latitude. Otherwise as write_panels_csv().
Result<void> write_row_metres_csv(const BlockProducts& block, const std::string& path);

/// The vertical profiles of all panels on all dates, a line for each band of heights: panel_uid, row_number,
/// panel_number, scan_id, scan_date, height_low_m, height_high_m, plant_area_m2, leaf_area_m2, block, farm, variety.
/// Otherwise as write_panels_csv().
Result<void> write_panel_profile_csv(const BlockProducts& block, const std::string& path);

}  // namespace rayfield::formats
