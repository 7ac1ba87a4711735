#pragma once

#include <optional>
#include <string>

#include "rayfield/core/result.h"
#include "rayfield/core/zone_products.h"
#include "rayfield/formats/farm_profile.h"

/// zones: management zones of a block as files, with or without a rate for each (docs/farm-systems.md). Files appear
/// whole or not at all; equal input gives equal bytes.
namespace rayfield::formats {

/// The layer `management_zone`, coloured. Errors: usage (CRS), internal, resources, bad_input (no such folder).
Result<void> write_zones_geopackage(const ZoneMap& map, const std::string& path);
/// RFC 7946 GeoJSON. Errors: as write_zones_geopackage().
Result<void> write_zones_geojson(const ZoneMap& map, const std::string& path);
/// Zipped shapefile after the rules of a farm system; with a prescription also rate, unit and product.
/// Errors: as write_zones_geopackage(); usage where the system takes fewer polygons.
Result<void> write_zones_shapefile(const ZoneMap& map, const std::optional<Prescription>& rates,
                                   const FarmProfile& profile, const std::string& path);

}  // namespace rayfield::formats
