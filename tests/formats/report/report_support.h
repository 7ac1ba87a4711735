#pragma once

#include <cstddef>
#include <utility>

#include "rayfield/formats/report.h"
#include "tests/formats/season_support.h"

/// Reports for the tests of the page.
namespace rayfield::formats::testing {

/// The block of make_block() on two dates with everything that a report wants: a map of 4 × 3 cells, a side view of
/// 6 × 4 cells of each row, two gaps.
inline BlockReport make_report(BlockProducts block) {
  BlockReport report;
  report.season = make_season(block);
  report.comparisons = {make_comparison(block)};
  report.weak = {{1, 1, 1, 0, 6.5, 1.25}};
  report.focus = 1, report.software = "rayfield 9.9";
  for (ScanResults& scan : block.scans) {
    ReportScan of_scan;
    of_scan.plan_density = Grid2<float>(block.rows[0].centreline[0], 5, 4, 3, 2.5F);
    of_scan.plan_density.at(3, 2) = kNanFloat;
    of_scan.gaps = {{1, 2.0, 3.5, block.rows[0].centreline[0] + Eigen::Vector2d(0, 2.75), 1}, {2, 0, 0.5, {}, 0}};
    of_scan.seen_as_gap = {2, 1};
    for (std::size_t i = 0; i < block.panels.size(); ++i) of_scan.classes.push_back(static_cast<int>(i) % 5);
    of_scan.inputs = {{"drive.bag", 1234567, "abc123"}};
    of_scan.alignment = "aligned: moved +1.00 m east", of_scan.beam = "13.6 mm + 11.9 mrad";
    of_scan.warnings = {"3 rays left out"};
    report.scans.push_back(std::move(of_scan));
    for (const RowProduct& row : block.rows)
      scan.sections.push_back({"side_view_row_" + std::to_string(row.row_number), "m2/m2", row.row_number,
                               Grid2<float>({0, 0.5}, 0.5, 6, 4, 1.5F)});
  }
  report.block = std::move(block);
  return report;
}
inline BlockReport make_report() { return make_report(make_block(2, 3, {"2018-11-22", "2019-02-11"})); }

}  // namespace rayfield::formats::testing
