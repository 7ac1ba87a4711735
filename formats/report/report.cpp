#include "rayfield/formats/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "formats/io/file_io.h"
#include "formats/io/guard.h"
#include "formats/io/text_escape.h"
#include "formats/report/page.h"
#include "formats/report/report_data.h"
#include "formats/report/report_quality.h"
#include "formats/report/report_summary.h"
#include "formats/report/report_tables.h"
#include "formats/report/report_words.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kWhat = "cannot write report";

Result<void> check_report(const BlockReport& report) {
  const BlockProducts& block = report.block;
  const auto refuse = [&](std::string_view why) { return fail(ErrorCode::usage, kWhat, block.block, why); };
  if (block.scans.empty() || block.panels.empty() || block.rows.empty())
    return refuse("the block has no rows, panels or dates");
  if (report.scans.size() != block.scans.size() || report.focus >= block.scans.size())
    return refuse("not one description for each date");
  for (const RowProduct& row : block.rows)
    if (row.centreline.size() < 2) return refuse("a row has no line");
  for (const ReportScan& scan : report.scans)
    if (scan.classes.size() != block.panels.size() || scan.seen_as_gap.size() != scan.gaps.size())
      return refuse("classes or gaps do not fit the panels");
  return {};
}

std::string heading(const BlockProducts& block) { return "Block " + block.block; }

std::string subheading(const BlockProducts& block) {
  std::string text;
  for (const std::string& name : {block.farm, block.variety})
    if (!name.empty()) text += name + " · ";
  const std::string first = date_text(block.scans.front().scan.scan_date),
                    last = date_text(block.scans.back().scan.scan_date);
  return text +
         fmt::format(
             "{} row{}, {} panels · {}", block.rows.size(), block.rows.size() == 1 ? "" : "s", block.panels.size(),
             block.scans.size() == 1 ? first : fmt::format("{} dates, {} to {}", block.scans.size(), first, last));
}

}  // namespace

int report_map_factor(const Grid2<float>& map, std::size_t dates, const ReportOptions& options) {
  for (int factor = 1;; ++factor) {
    const auto columns = static_cast<std::size_t>((map.nx + factor - 1) / factor);
    const auto rows = static_cast<std::size_t>((map.ny + factor - 1) / factor);
    if (columns * rows * dates <= options.max_map_cells || columns * rows <= 1) return factor;
  }
}

Grid2<float> coarser(const Grid2<float>& grid, int factor) {
  if (factor <= 1) return grid;
  Grid2<float> out(grid.origin, grid.cell_m * factor, (grid.nx + factor - 1) / factor, (grid.ny + factor - 1) / factor,
                   std::numeric_limits<float>::quiet_NaN());
  for (int y = 0; y < out.ny; ++y)
    for (int x = 0; x < out.nx; ++x) {
      double sum = 0;
      int count = 0;
      for (int dy = y * factor; dy < std::min(grid.ny, (y + 1) * factor); ++dy)
        for (int dx = x * factor; dx < std::min(grid.nx, (x + 1) * factor); ++dx)
          if (const auto value = static_cast<double>(grid.at(dx, dy)); std::isfinite(value)) sum += value, ++count;
      if (count > 0) out.at(x, y) = static_cast<float>(sum / count);
    }
  return out;
}

Result<bool> is_report(const std::string& path) {
  constexpr std::string_view kBeginning = "<!doctype html>\n<!-- rayfield report -->";
  RAYFIELD_ASSIGN(const InputFile file, InputFile::open(path, std::string(kWhat)));
  std::string beginning(kBeginning.size(), '\0');
  RAYFIELD_ASSIGN(const std::size_t count, file.read_at(0, std::as_writable_bytes(std::span(beginning))));
  return count == kBeginning.size() && beginning == kBeginning;
}

Result<std::string> report_html(const BlockReport& report, const ReportOptions& options) {
  return guarded(kWhat, report.block.block, [&]() -> Result<std::string> {
    RAYFIELD_CHECK(check_report(report));
    RAYFIELD_ASSIGN(std::string data, report_data(report, options));
    const std::string name = xml_escape(heading(report.block));
    return page(
        {{"title", name + " – canopy report"},
         {"software", xml_escape(report.software)},
         {"heading", name},
         {"subheading", xml_escape(subheading(report.block))},
         {"tiles", tiles_html(report)},
         {"look", look_html(report)},
         {"ends", ends_html(report)},
         {"gaps", gaps_html(report)},
         {"quality", quality_html(report)},
         {"footer", "Made with " + xml_escape(report.software) + " from snapshot " +
                        std::to_string(report.block.snapshot) + ". This file needs no network and sends nothing."}},
        std::move(data));
  });
}

}  // namespace rayfield::formats
