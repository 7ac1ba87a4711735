#include "rayfield/density/findings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "libdensity/layout/polyline.h"
#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool is_side_view(const SectionProduct& section) { return section.name.starts_with("side_view"); }

// Plant area per metre of row of each column of a side view, m²/m; NaN where less than half of it was seen.
std::vector<double> column_areas(const Grid2<float>& side) {
  std::vector<double> areas(static_cast<std::size_t>(side.nx), kNaN);
  for (int x = 0; x < side.nx; ++x) {
    double sum = 0;
    int seen = 0;
    for (int y = 0; y < side.ny; ++y) {
      const double density = static_cast<double>(side.at(x, y));
      if (std::isfinite(density)) sum += density, ++seen;
    }
    if (2 * seen >= side.ny && seen > 0) areas[static_cast<std::size_t>(x)] = sum * side.cell_m;
  }
  return areas;
}

// One row's side view as columns, and what else it takes to find its gaps.
struct RowColumns {
  const RowProduct& row;
  double first_m, cell_m;  // start and width of the columns along the row
  std::vector<double> areas;
  std::vector<double> posts_m;

  double start_of(std::size_t column) const { return first_m + cell_m * static_cast<double>(column); }
  bool at_post(std::size_t column, double reach_m) const {
    const double middle = start_of(column) + cell_m / 2;
    return std::any_of(posts_m.begin(), posts_m.end(), [&](double m) { return std::abs(m - middle) <= reach_m; });
  }
};

std::vector<RowColumns> columns_of(const BlockProducts& block, const ScanResults& scan) {
  std::vector<RowColumns> out;
  for (const RowProduct& row : block.rows)
    for (const SectionProduct& section : scan.sections) {
      if (section.row_number != row.row_number || !is_side_view(section)) continue;
      RowColumns columns{row, section.grid.origin.x(), section.grid.cell_m, column_areas(section.grid), {}};
      for (const PostProduct& post : block.posts)
        if (post.row_number == row.row_number) columns.posts_m.push_back(post.chainage_m);
      out.push_back(std::move(columns));
    }
  return out;
}

double median_column(const std::vector<RowColumns>& rows) {
  std::vector<double> seen;
  for (const RowColumns& row : rows)
    std::copy_if(row.areas.begin(), row.areas.end(), std::back_inserter(seen),
                 [](double a) { return std::isfinite(a); });
  return median_of(std::move(seen));
}

int panel_at(const BlockProducts& block, int row_number, double chainage_m) {
  for (const PanelProduct& panel : block.panels)
    if (panel.row_number == row_number && chainage_m >= panel.chainage_start_m && chainage_m < panel.chainage_end_m)
      return panel.panel_number;
  return 0;
}

// Columns at posts may lie within a gap but are not its ends.
void find_in_row(const BlockProducts& block, const RowColumns& columns, double limit, const GapOptions& options,
                 std::vector<RowGap>& gaps) {
  double start = kNaN, end = kNaN;
  const auto close = [&] {
    if (!std::isfinite(start)) return;
    RowGap gap{columns.row.row_number, std::max(0.0, start), std::min(columns.row.length_m, end)};
    start = end = kNaN;
    if (gap.length_m() < options.min_length_m - 1e-9) return;
    const double middle = (gap.start_m + gap.end_m) / 2;
    gap.position = point_at(columns.row.centreline, middle).position;
    gap.panel_number = panel_at(block, gap.row_number, middle);
    gaps.push_back(gap);
  };
  for (std::size_t i = 0; i < columns.areas.size(); ++i) {
    if (std::isfinite(columns.areas[i]) && columns.at_post(i, options.post_reach_m)) continue;
    if (columns.areas[i] < limit) {  // false for what was not seen
      if (!std::isfinite(start)) start = columns.start_of(i);
      end = columns.start_of(i + 1);
    } else {
      close();
    }
  }
  close();
}

std::map<std::string, const PanelValue*> by_panel(const ScanResults& scan) {
  std::map<std::string, const PanelValue*> out;
  for (const PanelValue& value : scan.panel_values) out[value.panel_uid] = &value;
  return out;
}

// Leaf area per metre of each of block.panels; NaN where not seen.
std::vector<double> leaf_areas(const BlockProducts& block, std::size_t scan) {
  const auto values = by_panel(block.scans[scan]);
  std::vector<double> out;
  for (const PanelProduct& panel : block.panels) {
    const auto found = values.find(panel.panel_uid);
    out.push_back(found == values.end() ? kNaN : found->second->leaf_area_per_m);
  }
  return out;
}

}  // namespace

Result<void> GapOptions::validate() const { return check_option_ranges(*this, "bad gap option"); }

Result<std::vector<RowGap>> find_gaps(const BlockProducts& block, std::size_t scan, const GapOptions& options) {
  RAYFIELD_CHECK(options.validate());
  if (scan >= block.scans.size())
    return fail(ErrorCode::usage, "cannot find gaps", block.block, "no such scan", "see `rayfield status`");
  const std::vector<RowColumns> rows = columns_of(block, block.scans[scan]);
  const double median = median_column(rows);
  std::vector<RowGap> gaps;
  if (!(median >= options.min_canopy_per_m)) return gaps;
  for (const RowColumns& columns : rows) find_in_row(block, columns, options.share_of_median * median, options, gaps);
  return gaps;
}

bool is_gap_among(const RowGap& gap, std::span<const RowGap> others) {
  double shared = 0;
  for (const RowGap& other : others)
    if (other.row_number == gap.row_number)
      shared += std::max(0.0, std::min(gap.end_m, other.end_m) - std::max(gap.start_m, other.start_m));
  return shared >= gap.length_m() / 2;
}

std::vector<int> panel_classes(const BlockProducts& block, std::size_t scan, int count) {
  const std::vector<double> areas = leaf_areas(block, scan);
  std::vector<double> sorted;
  std::copy_if(areas.begin(), areas.end(), std::back_inserter(sorted), [](double a) { return std::isfinite(a); });
  std::sort(sorted.begin(), sorted.end());
  std::vector<int> classes;
  for (const double area : areas) {
    const auto below = std::lower_bound(sorted.begin(), sorted.end(), area) - sorted.begin();
    classes.push_back(std::isfinite(area) ? static_cast<int>(below * count / static_cast<std::ptrdiff_t>(sorted.size()))
                                          : -1);
  }
  return classes;
}

std::vector<WeakStretch> weak_stretches(const BlockProducts& block, std::size_t scan, std::span<const int> classes) {
  const auto values = by_panel(block.scans[scan]);
  std::vector<WeakStretch> out;
  double leaf = 0, length = 0;
  for (std::size_t i = 0; i < block.panels.size(); ++i) {
    if (classes[i] != 0) continue;
    const PanelProduct& panel = block.panels[i];
    const bool goes_on = i > 0 && classes[i - 1] == 0 && block.panels[i - 1].row_number == panel.row_number &&
                         block.panels[i - 1].panel_number + 1 == panel.panel_number;
    if (!goes_on) {
      out.push_back({panel.row_number, panel.panel_number, 0, panel.chainage_start_m, 0, 0});
      leaf = length = 0;
    }
    leaf += values.at(panel.panel_uid)->leaf_area_m2, length += panel.length_m;
    out.back().last_panel = panel.panel_number, out.back().end_m = panel.chainage_end_m;
    out.back().leaf_area_per_m = leaf / length;
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const WeakStretch& a, const WeakStretch& b) { return a.leaf_area_per_m < b.leaf_area_per_m; });
  return out;
}

}  // namespace rayfield::density
