#include "libdensity/scan/scan_sides.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libdensity/rows/rows.h"
#include "libdensity/scan/scan_echoes.h"

namespace rayfield::density {
namespace {

constexpr double kDrivenAlong = 0.5;  // of the row
constexpr double kThinOneSideError = 0.03, kWideOneSideError = 0.12;

bool is_among(int row, std::span<const int> rows) { return std::find(rows.begin(), rows.end(), row) != rows.end(); }

}  // namespace

std::vector<int> rows_from_one_side(const RowLayout& layout, std::span<const PathPoint> path,
                                    const RowOptions& options) {
  const std::vector<Pass> passes = find_passes(path, options.passes);
  std::vector<int> rows;
  for (const Row& row : layout.rows) {
    const auto [left, right] = driven_shares(row.centreline, passes, options);
    if ((left >= kDrivenAlong) != (right >= kDrivenAlong)) rows.push_back(row.number);
  }
  return rows;
}

IntegrationOptions integration_of_row(const IntegrationOptions& integration, const tile::ScanEntry& scan, int row,
                                      std::span<const int> rows_from_one_side) {
  if (!is_among(row, rows_from_one_side)) return integration;
  IntegrationOptions options = integration;
  const double error = has_thin_beam(scan) ? kThinOneSideError : kWideOneSideError;
  options.shared_error = std::min(1.0, std::hypot(options.shared_error, error));
  return options;
}

std::string one_side_note(const tile::ScanEntry& scan, const RowLayout& layout,
                          std::span<const int> rows_from_one_side) {
  std::vector<int> shown;
  for (const Row& row : layout.rows)
    if (is_among(row.number, rows_from_one_side)) shown.push_back(row.shown_number());
  if (shown.empty()) return {};
  const bool one = shown.size() == 1;
  return fmt::format(
      "{} {} of {} {} driven past on one side only: what stands behind is seen through the front, and areas there are "
      "off "
      "by another {:.0f} %, which is in their intervals",
      one ? "row" : "rows", fmt::join(shown, ", "), scan.scan_id, one ? "was" : "were",
      100 * (has_thin_beam(scan) ? kThinOneSideError : kWideOneSideError));
}

}  // namespace rayfield::density
