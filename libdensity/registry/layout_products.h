#pragma once

#include <string>

#include "libdensity/ground/ground_model.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/products.h"

namespace rayfield::density {

/// The layout as products. `half_width_m`: of the panels' outlines, about the canopy's. `ground` may lack places: the
/// height is NaN there.
/// Rows go by the farm's numbers where they have any.
BlockProducts layout_products(const RowLayout& layout, const std::string& block, const std::string& crs,
                              const GroundModel& ground, double half_width_m);

}  // namespace rayfield::density
