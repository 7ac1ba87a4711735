#pragma once

#include <string>

#include "rayfield/core/result.h"
#include "rayfield/core/surveyed_block.h"

namespace rayfield::formats {

/// Surveyed rows and posts from a GeoPackage (.gpkg), GeoJSON (.geojson, .json) or CSV (.csv), in the map coordinates
/// of `crs` (docs/registry.md). Lines are rows, points are posts; polygons are ignored. Fields, in any case:
/// `row_number` or `row` (a whole number; other text in `row` is a name), `row_name` or `name`, `height_m`,
/// `diameter_m`; what has a `valid_to` is gone and ignored. CSV: one post per line, or with `kind` "row" one vertex
/// of a row's line; longitude/latitude (lon/lat) on WGS 84, or easting/northing (x/y) in `crs`. GeoJSON without a CRS
/// is WGS 84 (RFC 7946). Everything is reprojected to `crs`. Errors: usage (unknown ending); bad_input, with the layer
/// or line and the reason: no CRS, coordinates outside the area of use of `crs`, a reference larger than a block, an
/// empty file; resources.
Result<SurveyedBlock> read_reference_file(const std::string& path, const std::string& crs);

}  // namespace rayfield::formats
