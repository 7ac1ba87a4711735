#pragma once

#include <map>
#include <optional>
#include <string>

#include "libdensity/layout/row_layout.h"
#include "libdensity/scan/scan_work.h"
#include "rayfield/core/products.h"

namespace rayfield::density {

/// Of a panel without its masked posts and trunks, as the scan's own rays show it.
struct ThinPlants {
  double area_m2 = 0, high_m2 = 0;  ///< leaves and thin wood, and the upper end of their interval
  bool operator==(const ThinPlants&) const = default;
};
using PanelPlants = std::map<std::string, ThinPlants>;  ///< by panel uid; of panels that have a value

/// What other scans of the block want to know of a scan, small enough to be read for all of them (kind "totals").
struct ScanTotals {
  double plant_area_m2 = 0, panel_length_m = 0;  ///< of the panels that have a value
  int panels = 0, panels_with_value = 0;         ///< of the layout, and those of them that were seen well enough
  double observed_fraction = 0;                  ///< share of voxels that two rays crossed, mean over all panels
  bool holds_downward_misses = false;            ///< see ground/survey.h
  PanelPlants thin_plants = {};                  ///< empty: of a version that did not keep them
  /// Nothing where no panel has a value.
  std::optional<double> plant_area_per_m() const;
};

/// Stored form (kind "totals"). Errors: damaged, where a number is missing or panels have not one value each.
tile::ArraySet arrays_from_totals(const ScanTotals& totals);
Result<ScanTotals> totals_from_arrays(const tile::ArraySet& arrays);

/// Sums up the results of `work.scan`, which are in its files, and keeps them there.
Result<ScanTotals> total_scan(ScanWork& work, const RowLayout& layout, const ScanResults& results,
                              bool holds_downward_misses);

/// Of a scan as the snapshot has it; nothing where it was not processed, or by a version that did not keep them.
Result<std::optional<ScanTotals>> read_totals(const tile::Store& store, const tile::ScanEntry& scan);

}  // namespace rayfield::density
