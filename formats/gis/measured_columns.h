#pragma once

#include <array>

#include "rayfield/core/products.h"

namespace rayfield::formats {

/// A measured value of a panel on a date.
struct MeasuredColumn {
  const char* name;
  double PanelValue::*value;
  const char* description;  ///< with the unit
  const char* short_name;   ///< of at most ten characters, for shapefiles
  const char* unit;
};

inline constexpr const char* kWoodScanDescription =
    "dormant scan whose wood was subtracted for the leaf area, see table scan; NULL: none, see wood_from";
inline constexpr const char* kWoodFromDescription =
    "what tells the wood that leaf areas are freed of: 'dormant scan'; 'estimate': posts and trunks found, the rest "
    "estimated from the canopy's size, with wide intervals; NULL: nothing, leaf areas hold canes and wires";
inline constexpr const char* kLeafAreaPerMDescription = "one-sided leaf area per metre of row, m²/m";

/// In the order of `panel_value`, `panel_by_date`, GeoJSON and CSV; everywhere ray_count follows as an integer and
/// wood_scan_id as text.
inline constexpr std::array<MeasuredColumn, 14> kMeasuredColumns = {{
    {"plant_area_m2", &PanelValue::plant_area_m2,
     "one-sided area of everything that stops rays: leaves, wood, posts, wires, m²", "plant_m2", "m2"},
    {"leaf_area_m2", &PanelValue::leaf_area_m2,
     "one-sided leaf area: plant area less the wood that the scan wood_scan_id shows, or, where that is NULL, less an "
     "estimate of it (wood_from), m²; may be slightly negative where there are no leaves",
     "leaf_m2", "m2"},
    {"leaf_area_per_m", &PanelValue::leaf_area_per_m, kLeafAreaPerMDescription, "leaf_per_m", "m2/m"},
    {"lai", &PanelValue::lai, "leaf area index: leaf area / (panel length × row spacing), m²/m²", "lai", "m2/m2"},
    {"se_leaf_area_m2", &PanelValue::se_leaf_area_m2, "standard error of leaf_area_m2, m²", "se_leaf_m2", "m2"},
    {"ci_low_m2", &PanelValue::ci_low_m2, "lower end of the 95 % interval of leaf_area_m2, m²", "ci_low_m2", "m2"},
    {"ci_high_m2", &PanelValue::ci_high_m2, "upper end of the 95 % interval of leaf_area_m2, m²", "ci_high_m2", "m2"},
    {"canopy_height_m", &PanelValue::canopy_height_m, "height of the canopy above the ground, m", "height_m", "m"},
    {"canopy_width_m", &PanelValue::canopy_width_m, "width of the canopy across the row, m", "width_m", "m"},
    {"gap_fraction", &PanelValue::gap_fraction, "share of the panel's side view that lets light through, 0 … 1",
     "gap_frac", "0-1"},
    {"observed_fraction", &PanelValue::observed_fraction, "share of voxels crossed by at least two rays, 0 … 1",
     "seen_frac", "0-1"},
    {"se_plant_area_m2", &PanelValue::se_plant_area_m2,
     "standard error of plant_area_m2, m²; two leaf areas with the same wood_scan_id differ by their plants, and so "
     "this is the error of each in their difference",
     "se_plnt_m2", "m2"},
    {"plant_ci_low_m2", &PanelValue::plant_ci_low_m2, "lower end of the 95 % interval of plant_area_m2, m²",
     "plnt_ci_lo", "m2"},
    {"plant_ci_high_m2", &PanelValue::plant_ci_high_m2, "upper end of the 95 % interval of plant_area_m2, m²",
     "plnt_ci_hi", "m2"},
}};

}  // namespace rayfield::formats
