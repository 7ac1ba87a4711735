#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rayfield/core/grid2.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"

/// A block with all its dates as one HTML document that needs no network: what a grower asks first, then the data
/// behind it and their uncertainty (docs/report.md).
namespace rayfield::formats {

/// A file that a scan was made of.
struct ReportInput {
  std::string name;
  std::uint64_t size = 0;
  std::string sha256;
};

/// What a report says of one of block.scans beside its values.
struct ReportScan {
  bool dormant = false;                  ///< the vines bear no leaves: neither weakness nor change is reported
  Grid2<float> plan_density;             ///< m²/m², in the frame of all dates, at the resolution shown
  std::vector<RowGap> gaps;              ///< of that date, row by row
  std::vector<std::size_t> seen_as_gap;  ///< for each gap, on how many of the dates with canopy it is one
  std::vector<int> classes;              ///< of block.panels: 0 weakest … kReportClasses − 1, −1 not seen
  std::vector<ReportInput> inputs;
  std::string alignment, beam;  ///< in words; beam may be empty: not known
  std::vector<std::string> warnings;
};
inline constexpr int kReportClasses = 5;

/// All that a report is made of. Side views are those of block.scans.
struct BlockReport {
  BlockProducts block;
  std::vector<ReportScan> scans;            ///< one for each of block.scans
  std::vector<SeasonValue> season;          ///< block and rows on all dates
  std::vector<DateComparison> comparisons;  ///< of every two dates, in the order (0,1), (0,2) … (1,2) …
  std::vector<WeakStretch> weak;            ///< of the date in focus, the weakest first
  std::size_t focus = 0;                    ///< the date that text and tables describe: the newest with leaves
  double min_gap_m = 0.5, gap_share = 0.2;  ///< what counts as a gap
  std::string software;                     ///< "rayfield 0.1.0"
};

/// Limits on the pictures in a report, in cells over all dates; maps and side views are made coarser by whole factors
/// until they fit.
struct ReportOptions {
  std::size_t max_map_cells = 5'000'000;
  std::size_t max_side_view_cells = 5'000'000;
};

/// The factor by which every map of `dates` dates has to be made coarser.
int report_map_factor(const Grid2<float>& map, std::size_t dates, const ReportOptions& options);

/// Means over blocks of factor × factor cells; cells without a value are left out, blocks without any are NaN. Cells at
/// the north and east edge may reach beyond the grid.
Grid2<float> coarser(const Grid2<float>& grid, int factor);

/// Whether a file is a report that rayfield has written. Errors: bad_input, resources.
Result<bool> is_report(const std::string& path);

/// The document. Text from users is escaped; nothing but the one script and the one style of the document can run in
/// it. Errors: usage (parts of the report that do not belong together), resources.
Result<std::string> report_html(const BlockReport& report, const ReportOptions& options = {});

}  // namespace rayfield::formats
