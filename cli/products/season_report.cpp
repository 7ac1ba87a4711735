#include "cli/products/season_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <list>

#include "cli/console/output_paths.h"
#include "cli/products/block_scales.h"
#include "rayfield/density/load.h"
#include "rayfield/density/season.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

using Paths = std::vector<fs::path>;

constexpr std::size_t kRowsPerSheet = 31;  // and the block: eight lines of four charts

// Curves of the block and its rows; blocks of many rows take several sheets.
Result<void> write_curves(const BlockProducts& block, const std::vector<SeasonValue>& values, const fs::path& folder,
                          Paths& written) {
  std::vector<int> rows;
  for (const RowProduct& row : block.rows) rows.push_back(row.row_number);
  formats::PictureOptions options;
  options.title = fmt::format("{}, leaf area through the season", block.block);
  options.subtitle = fmt::format("{} dates, {} to {}", block.scans.size(), block.scans.front().scan.scan_date,
                                 block.scans.back().scan.scan_date);
  const std::size_t sheets = std::max<std::size_t>(1, (rows.size() + kRowsPerSheet - 1) / kRowsPerSheet);
  for (std::size_t sheet = 0; sheet < sheets; ++sheet) {
    const std::size_t first = sheet * kRowsPerSheet, count = std::min(kRowsPerSheet, rows.size() - first);
    const std::string suffix = sheet == 0 ? "" : fmt::format("_{}", sheet + 1);
    for (const char* ending : {"png", "svg"}) {
      written.push_back(folder / fmt::format("{}_season{}.{}", block.block, suffix, ending));
      RAYFIELD_CHECK(formats::write_season_chart(block, values, std::span<const int>(rows).subspan(first, count),
                                                 written.back().string(), options));
    }
  }
  return {};
}

std::string stack_label(const std::vector<SeasonValue>& values, int row, const ScanProduct& scan) {
  std::string date = scan.name.empty() ? scan.scan_date : scan.scan_date + ", " + scan.name;
  for (const SeasonValue& v : values)
    if (v.row_number == row && v.scan_id == scan.scan_id && std::isfinite(v.leaf_area_per_m))
      return fmt::format("{}   leaf area {:.2f} m²/m", date, v.leaf_area_per_m);
  return date;
}

// One row's side views, date under date.
Result<void> write_row_stack(const tile::Store& store, const tile::Snapshot& snapshot, const BlockProducts& block,
                             const std::vector<SeasonValue>& values, const RowProduct& row,
                             const formats::ColorScale& scale, const fs::path& folder, Paths& written) {
  std::list<std::vector<SectionProduct>> views;
  std::vector<formats::LabelledSection> dates;
  for (const ScanResults& results : block.scans) {
    const tile::ScanEntry& scan = *snapshot.find_scan(results.scan.scan_id);
    RAYFIELD_ASSIGN(auto of_scan, density::load_sections(store, snapshot, scan, "side_view", row.row_number));
    for (const SectionProduct& section : views.emplace_back(std::move(of_scan))) {
      formats::LabelledSection labelled{&section, stack_label(values, row.row_number, results.scan), {}};
      for (const PostProduct& post : block.posts)
        if (post.row_number == row.row_number) labelled.marks_m.push_back(post.chainage_m);
      dates.push_back(std::move(labelled));
    }
  }
  if (dates.empty()) return {};
  formats::PictureOptions options;
  options.title = fmt::format("{}, row {}", block.block, row.row_number);
  options.subtitle = "side views through the season";
  options.scale = scale;
  options.max_height_px = 20000;  // the more dates, the higher: no date is drawn smaller for it
  for (const char* ending : {"png", "svg"}) {
    written.push_back(folder / fmt::format("{}_row_{}_stack.{}", block.block, row.row_number, ending));
    RAYFIELD_CHECK(formats::write_row_stack_picture(dates, written.back().string(), options));
  }
  return {};
}

}  // namespace

Result<SeasonReport> report_season(const tile::Store& store, const std::optional<fs::path>& folder,
                                   Progress& progress) {
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const auto selected, density::select_results(snapshot, {}));
  for (const std::string& line : selected.left_out) progress.warn(line);
  RAYFIELD_ASSIGN(const BlockProducts block, density::load_block(store, snapshot, selected.scan_ids));
  if (block.scans.size() < 2)
    return fail(ErrorCode::usage, "cannot compare dates", store.folder().string(), "the block has one date only",
                "add and process another");
  SeasonReport report{density::season_values(block), {}};
  if (!folder) return report;
  RAYFIELD_ASSIGN(const OutputFolder made, OutputFolder::make(*folder));
  progress.stage("season", block.rows.size() + 1, "pictures");
  report.files.push_back(*folder / (block.block + "_season.csv"));
  RAYFIELD_CHECK(formats::write_season_csv(report.values, report.files.back().string()));
  RAYFIELD_CHECK(write_curves(block, report.values, *folder, report.files));
  progress.advance(1);
  RAYFIELD_ASSIGN(const BlockScales scales, fit_block_scales(store, snapshot, progress));
  for (const RowProduct& row : block.rows) {
    if (progress.cancelled())
      return fail(ErrorCode::interrupted, "interrupted", folder->string(), "", "run the same command again");
    RAYFIELD_CHECK(
        write_row_stack(store, snapshot, block, report.values, row, scales.at("side_view"), *folder, report.files));
    progress.advance(1);
  }
  return report;
}

}  // namespace rayfield::cli
