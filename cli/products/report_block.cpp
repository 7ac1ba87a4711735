#include "cli/products/report_block.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <system_error>

#include "cli/console/alignment_text.h"
#include "cli/console/beam_text.h"
#include "cli/console/output_paths.h"
#include "rayfield/density/load.h"
#include "rayfield/density/season.h"
#include "version.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;
constexpr const char* kWhat = "cannot write report";

// The vines bear no leaves: the user says so, or it is the scan whose wood is subtracted from the others.
bool is_dormant(const tile::ScanEntry& entry, const ScanProduct& product) {
  return entry.dormant.value_or(product.wood_scan_id == product.scan_id);
}

formats::ReportScan describe(const tile::ScanEntry& entry, const ScanProduct& product) {
  formats::ReportScan scan;
  scan.dormant = is_dormant(entry, product);
  for (const tile::InputEntry& input : entry.inputs) scan.inputs.push_back({input.name, input.size, input.sha256});
  scan.alignment = entry.alignment ? alignment_text(*entry.alignment) : "not known: added by an older version";
  if (entry.beam) scan.beam = beam_text(*entry.beam);
  scan.warnings = entry.warnings;
  return scan;
}

// On how many dates with leaves each gap is one, its own included.
void count_dates_of_gaps(std::vector<formats::ReportScan>& scans) {
  for (formats::ReportScan& scan : scans)
    for (const RowGap& gap : scan.gaps)
      scan.seen_as_gap.push_back(
          static_cast<std::size_t>(std::count_if(scans.begin(), scans.end(), [&](const formats::ReportScan& other) {
            return !other.dormant && density::is_gap_among(gap, other.gaps);
          })));
}

// The newest date with leaves; of bare ones alone the newest.
std::size_t date_in_focus(const std::vector<formats::ReportScan>& scans) {
  for (std::size_t i = scans.size(); i-- > 0;)
    if (!scans[i].dormant) return i;
  return scans.size() - 1;
}

// Every two dates that can be compared: those without a panel that both saw are left out.
Result<std::vector<DateComparison>> compare_all(const BlockProducts& block, const density::ComparisonOptions& options) {
  std::vector<DateComparison> comparisons;
  for (std::size_t a = 0; a < block.scans.size(); ++a)
    for (std::size_t b = a + 1; b < block.scans.size(); ++b) {
      auto comparison = density::compare_dates(block, a, b, options);
      if (comparison)
        comparisons.push_back(std::move(*comparison));
      else if (comparison.error().code != ErrorCode::bad_input)
        return tl::make_unexpected(std::move(comparison).error());
    }
  return comparisons;
}

Result<void> load_map(const tile::Store& store, const tile::Snapshot& snapshot, const tile::ScanEntry& entry,
                      std::size_t dates, formats::ReportScan& scan) {
  RAYFIELD_ASSIGN(const RasterProduct map, density::load_raster(store, snapshot, entry, "plan_density"));
  scan.plan_density = formats::coarser(map.grid, formats::report_map_factor(map.grid, dates, {}));
  return {};
}

}  // namespace

Result<void> check_report_target(const std::string& path, bool overwrite) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
    return fail(ErrorCode::resources, kWhat, path, "a folder is in the way", "remove it, or give another -o");
  const OutputPath output{"-o", kWhat, path};
  RAYFIELD_CHECK(check_outputs(std::span(&output, 1), {}, true));
  if (overwrite || !fs::exists(path, ignored)) return {};
  RAYFIELD_ASSIGN(const bool ours, formats::is_report(path));
  if (!ours)
    return fail(ErrorCode::usage, kWhat, path, "it is there already and no report", "give another -o, or --overwrite");
  return {};
}

Result<formats::BlockReport> load_report(const tile::Store& store, const ReportRequest& request, Progress& progress) {
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const auto selected, density::select_results(snapshot, request.dates));
  for (const std::string& line : selected.left_out) progress.warn(line);
  formats::BlockReport report;
  RAYFIELD_ASSIGN(report.block, density::load_block(store, snapshot, selected.scan_ids));
  for (ScanResults& results : report.block.scans) {
    const tile::ScanEntry& entry = *snapshot.find_scan(results.scan.scan_id);
    RAYFIELD_ASSIGN(results.sections, density::load_sections(store, snapshot, entry, "side_view"));
  }
  const BlockProducts& block = report.block;
  progress.stage("report", block.scans.size(), "dates");
  for (std::size_t i = 0; i < block.scans.size(); ++i) {
    if (progress.cancelled())
      return fail(ErrorCode::interrupted, "interrupted", store.folder().string(), "", "run the same command again");
    const tile::ScanEntry& entry = *snapshot.find_scan(block.scans[i].scan.scan_id);
    formats::ReportScan scan = describe(entry, block.scans[i].scan);
    scan.classes = density::panel_classes(block, i, formats::kReportClasses);
    if (!scan.dormant) {
      RAYFIELD_ASSIGN(scan.gaps, density::find_gaps(block, i, request.settings.gaps));
    }
    RAYFIELD_CHECK(load_map(store, snapshot, entry, block.scans.size(), scan));
    report.scans.push_back(std::move(scan));
    progress.advance(1);
  }
  count_dates_of_gaps(report.scans);
  report.season = density::season_values(block);
  RAYFIELD_ASSIGN(report.comparisons, compare_all(block, request.settings.compare));
  report.focus = date_in_focus(report.scans);
  if (!report.scans[report.focus].dormant)
    report.weak = density::weak_stretches(block, report.focus, report.scans[report.focus].classes);
  report.min_gap_m = request.settings.gaps.min_length_m, report.gap_share = request.settings.gaps.share_of_median;
  report.software = fmt::format("rayfield {}", kVersion);
  return report;
}

}  // namespace rayfield::cli
