#pragma once

#include <optional>
#include <vector>

#include "formats/gis/vector_table.h"
#include "rayfield/core/zone_products.h"
#include "rayfield/formats/style.h"

namespace rayfield::formats {

/// Columns of the zones, as all formats have them; with rates also rate, rate_unit and product.
std::vector<VectorColumn> zone_columns(bool with_rates);

/// Light for low zones, dark for high ones.
Rgba zone_color(const ZoneMap& map, int zone);

/// One multipolygon per zone, in map coordinates, coloured.
VectorTable zone_table(const ZoneMap& map, const std::optional<Prescription>& rates);

}  // namespace rayfield::formats
