#pragma once

#include <cstddef>
#include <string>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"

/// Panels and their values for other software. Files appear whole or not at all; equal input gives equal bytes.
namespace rayfield::formats {

/// The panels of one scan as RFC 7946 GeoJSON: polygons in longitude and latitude (WGS 84, 9 decimals), outer rings
/// counter-clockwise, properties named as the columns of `panel_by_date`, NaN as null. A panel without a value on that
/// scan has only its own properties.
/// Errors: usage (CRS, `scan_index` beyond the scans), internal (coordinates), resources, bad_input (no such folder).
Result<void> write_panels_geojson(const BlockProducts& block, std::size_t scan_index, const std::string& path);

/// All panels on all dates, one line each, with a header line (RFC 4180, UTF-8, decimal points, ISO dates, LF). Columns
/// as in `panel_by_date`; NaN is an empty field. Errors: resources, bad_input (no such folder).
Result<void> write_panels_csv(const BlockProducts& block, const std::string& path);

/// All half metres of row on all dates: row_number, chainage_m, easting_m, northing_m, scan_id, scan_date,
/// leaf_area_per_m, plant_area_per_m. Otherwise as write_panels_csv().
Result<void> write_row_metres_csv(const BlockProducts& block, const std::string& path);

}  // namespace rayfield::formats
