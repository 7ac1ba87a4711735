#pragma once

#include <span>
#include <string>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"

/// What changed in a block, for GIS and tables. Files appear whole or not at all; equal input gives equal bytes.
namespace rayfield::formats {

/// A GeoPackage of its own with one layer, `panel_change`: the panels' outlines with both dates, their change, its
/// interval and whether it is significant (docs/compare.md), coloured on a fixed scale. Panels that were not seen on
/// one of the dates have NULL. Errors: as write_geopackage().
Result<void> write_change_geopackage(const BlockProducts& block, const DateComparison& comparison,
                                     const std::string& path);

/// The same columns as CSV, one line for each panel. Errors: resources, bad_input (no such folder).
Result<void> write_change_csv(const DateComparison& comparison, const std::string& path);

/// The block and its rows on all dates as CSV: row_number (empty: the whole block), scan_id, scan_date, panels,
/// panels_seen, length_m, leaf_area_m2, leaf_area_per_m, ci_low_per_m, ci_high_per_m, plant_area_m2, plant_area_per_m.
/// Errors: as write_change_csv().
Result<void> write_season_csv(std::span<const SeasonValue> values, const std::string& path);

}  // namespace rayfield::formats
