#pragma once

#include <array>

#include "rayfield/core/products.h"

namespace rayfield::formats {

/// A measured value of a panel on a date.
struct MeasuredColumn {
  const char* name;
  double PanelValue::*value;
  const char* description;  ///< with the unit
};

inline constexpr const char* kLeafAreaPerMDescription = "one-sided leaf area per metre of row, m²/m";

/// In the order of `panel_value`, `panel_by_date`, GeoJSON and CSV; everywhere ray_count follows as an integer.
inline constexpr std::array<MeasuredColumn, 11> kMeasuredColumns = {{
    {"plant_area_m2", &PanelValue::plant_area_m2,
     "one-sided area of everything that stops rays: leaves, wood, posts, wires, m²"},
    {"leaf_area_m2", &PanelValue::leaf_area_m2, "one-sided leaf area: plant area less structure, m²"},
    {"leaf_area_per_m", &PanelValue::leaf_area_per_m, kLeafAreaPerMDescription},
    {"lai", &PanelValue::lai, "leaf area index: leaf area / (panel length × row spacing), m²/m²"},
    {"se_leaf_area_m2", &PanelValue::se_leaf_area_m2, "standard error of leaf_area_m2, m²"},
    {"ci_low_m2", &PanelValue::ci_low_m2, "lower end of the 95 % interval of leaf_area_m2, m²"},
    {"ci_high_m2", &PanelValue::ci_high_m2, "upper end of the 95 % interval of leaf_area_m2, m²"},
    {"canopy_height_m", &PanelValue::canopy_height_m, "height of the canopy above the ground, m"},
    {"canopy_width_m", &PanelValue::canopy_width_m, "width of the canopy across the row, m"},
    {"gap_fraction", &PanelValue::gap_fraction, "share of the panel's side view that lets light through, 0 … 1"},
    {"observed_fraction", &PanelValue::observed_fraction, "share of voxels crossed by at least two rays, 0 … 1"},
}};

}  // namespace rayfield::formats
