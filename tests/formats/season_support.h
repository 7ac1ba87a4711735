#pragma once

#include <vector>

#include "rayfield/core/season_products.h"
#include "tests/formats/products_support.h"

/// Changes of a block for the tests of charts and layers.
namespace rayfield::formats::testing {

/// The two dates of a block of make_block() compared: panels gain, lose, stay and were not seen, in turn.
inline DateComparison make_comparison(const BlockProducts& block) {
  DateComparison c;
  c.a = block.scans[0].scan, c.b = block.scans[1].scan;
  for (std::size_t i = 0; i < block.panels.size(); ++i) {
    PanelChange p;
    p.panel_uid = block.panels[i].panel_uid, p.length_m = block.panels[i].length_m;
    p.row_number = block.panels[i].row_number, p.panel_number = block.panels[i].panel_number;
    p.a = block.scans[0].panel_values[i], p.b = block.scans[1].panel_values[i];
    p.verdict =
        std::vector{ChangeVerdict::gain, ChangeVerdict::loss, ChangeVerdict::none, ChangeVerdict::not_seen}[i % 4];
    if (p.verdict == ChangeVerdict::not_seen) {
      p.b.leaf_area_m2 = p.b.plant_area_m2 = kNan;
      p.leaf_change_m2 = p.leaf_change_per_m = p.leaf_change_percent = p.plant_change_m2 = kNan;
      p.se_change_m2 = p.ci_low_m2 = p.ci_high_m2 = p.p_value = kNan;
      ++c.not_seen;
    } else {
      p.leaf_change_m2 = 0.8125, p.leaf_change_per_m = 0.125, p.leaf_change_percent = 12.5, p.plant_change_m2 = 0.75;
      p.se_change_m2 = 0.25, p.ci_low_m2 = 0.3225, p.ci_high_m2 = 1.3025, p.p_value = 0.0012;
      ++c.compared;
      c.gains += p.verdict == ChangeVerdict::gain ? 1U : 0U, c.losses += p.verdict == ChangeVerdict::loss ? 1U : 0U;
    }
    c.panels.push_back(p);
  }
  c.leaf_total = {100, 120, 20, 2, 16, 24, ChangeVerdict::gain};
  c.leaf_per_m = {c.compared, 2, 2.4, 0.5, 0.227, 1.1, 0.2, 1.12, 0.16, 0.9};
  return c;
}

/// The block and its rows on all dates; the second row was not seen whole on the last.
inline std::vector<SeasonValue> make_season(const BlockProducts& block) {
  std::vector<SeasonValue> values;
  for (std::size_t d = 0; d < block.scans.size(); ++d)
    for (int row = 0; row <= static_cast<int>(block.rows.size()); ++row) {
      SeasonValue v;
      v.row_number = row;
      v.scan_id = block.scans[d].scan.scan_id, v.scan_date = block.scans[d].scan.scan_date;
      v.panels = 2, v.panels_seen = row == 2 && d + 1 == block.scans.size() ? 1 : 2;
      v.length_m = 13, v.leaf_area_per_m = 1.5 + static_cast<double>(d) + 0.25 * row;
      v.leaf_area_m2 = 13 * v.leaf_area_per_m, v.plant_area_m2 = v.leaf_area_m2 + 2;
      v.plant_area_per_m = v.plant_area_m2 / 13;
      v.ci_low_per_m = v.leaf_area_per_m - 0.1, v.ci_high_per_m = v.leaf_area_per_m + 0.1;
      values.push_back(v);
    }
  return values;
}

}  // namespace rayfield::formats::testing
