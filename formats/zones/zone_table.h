#pragma once

#include <optional>
#include <vector>

#include "formats/gis/vector_table.h"
#include "rayfield/core/zone_products.h"

namespace rayfield::formats {

/// Columns of the zones, as all formats have them; with rates also rate, rate_unit and product.
std::vector<VectorColumn> zone_columns(bool with_rates);

/// One multipolygon per zone, in map coordinates, coloured from light (low) to dark (high).
VectorTable zone_table(const ZoneMap& map, const std::optional<Prescription>& rates);

}  // namespace rayfield::formats
