#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "rayfield/core/products.h"

/// Small blocks of products for the tests of seasons.
namespace rayfield::density::testing {

inline constexpr double kRoot = 1.959963984540054;

/// A panel's value with the two errors of its interval: `own` of its voxels, `shared` relative.
inline PanelValue value_of(double leaf_m2, double own_m2, double shared) {
  PanelValue v;
  v.leaf_area_m2 = leaf_m2, v.plant_area_m2 = leaf_m2 + 1.5;
  v.se_leaf_area_m2 = own_m2;
  const double half = kRoot * std::hypot(own_m2, shared * leaf_m2);
  v.ci_low_m2 = std::fmax(0.0, leaf_m2 - half), v.ci_high_m2 = leaf_m2 + half;
  v.observed_fraction = 1, v.ray_count = 1000;
  return v;
}

/// A block of rows of `per_row` panels of 6 m; dates[d][i] is panel i on date d.
inline BlockProducts block_of(const std::vector<std::vector<PanelValue>>& dates, int per_row = 2) {
  BlockProducts block;
  block.block = "block", block.crs = "EPSG:7854";
  for (std::size_t i = 0; i < dates.front().size(); ++i) {
    const int row = static_cast<int>(i) / per_row + 1, number = static_cast<int>(i) % per_row + 1;
    if (number == 1) block.rows.push_back({"row-" + std::to_string(row), row, {}, 6.0 * per_row, 2.5});
    block.panels.push_back({"panel-" + std::to_string(i), row, number, 6.0 * (number - 1), 6.0 * number, 6.0, {}});
  }
  for (std::size_t d = 0; d < dates.size(); ++d) {
    ScanResults scan;
    scan.scan.scan_id = scan.scan.scan_date = "2021-0" + std::to_string(d + 1) + "-01";
    for (std::size_t i = 0; i < dates[d].size(); ++i) {
      PanelValue v = dates[d][i];
      v.panel_uid = block.panels[i].panel_uid, v.scan_id = scan.scan.scan_id, v.scan_date = scan.scan.scan_date;
      scan.panel_values.push_back(v);
    }
    block.scans.push_back(scan);
  }
  return block;
}

}  // namespace rayfield::density::testing
