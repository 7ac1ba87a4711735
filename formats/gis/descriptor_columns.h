#pragma once

#include <array>

#include "rayfield/core/products.h"

namespace rayfield::formats {

/// A canopy descriptor of a panel or of half a metre of row (docs/descriptors.md).
struct DescriptorColumn {
  const char* name;
  double CanopyDescriptors::*value;
  const char* description;  ///< with the unit
  const char* short_name;   ///< of at most ten characters, for shapefiles
  const char* unit;
};

/// In the order of all tables that have them, where they follow what was there before.
inline constexpr std::array<DescriptorColumn, 7> kDescriptorColumns = {{
    {"canopy_base_m", &CanopyDescriptors::canopy_base_m, "height of the canopy's lower edge above the ground, m",
     "base_m", "m"},
    {"row_gap_share", &CanopyDescriptors::row_gap_share,
     "share of the row's length without canopy, by half metres, 0 … 1", "row_gaps", "0-1"},
    {"porosity", &CanopyDescriptors::porosity,
     "share of horizontal lines across the row, inside the outline of the canopy, that meet neither leaf nor wood, 0 … "
     "1",
     "porosity", "0-1"},
    {"leaf_layer_number", &CanopyDescriptors::leaf_layer_number,
     "leaves on a horizontal line across the row, mean inside the outline of the canopy; leaves as in leaf_area", "lln",
     "1"},
    {"exposed_leaf_share", &CanopyDescriptors::exposed_leaf_share,
     "share of these leaves that are the first or the last of their line, 0 … 1", "exposed", "0-1"},
    {"fruit_zone_area_per_m", &CanopyDescriptors::fruit_zone_area_per_m,
     "one-sided leaf area in the fruit zone (heights: table scan) per metre of row, m²/m", "fz_per_m", "m2/m"},
    {"fruit_zone_density", &CanopyDescriptors::fruit_zone_density,
     "one-sided leaf area in the fruit zone per volume, over the canopy's width, m²/m³", "fz_density", "m2/m3"},
}};

}  // namespace rayfield::formats
