#include "rayfield/density/process.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <list>
#include <map>
#include <memory>

#include "libdensity/leaf/block_seasons.h"
#include "libdensity/leaf/leaf_products.h"
#include "libdensity/leaf/scan_totals.h"
#include "libdensity/learning/block_registry.h"
#include "libdensity/pipeline/processed_scan.h"
#include "libdensity/pipeline/scan_products.h"
#include "libdensity/scan/estimation.h"
#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/scan_leaf_angles.h"
#include "libdensity/scan/scan_sides.h"
#include "libdensity/scan/scan_stages.h"
#include "libdensity/scan/scan_voxel_size.h"
#include "libdensity/scan/scan_voxels.h"
#include "rayfield/core/parallel.h"
#include "rayfield/density/load.h"

namespace rayfield::density {
namespace {

// A scan on its way: its plants are known before the wood of any is subtracted.
struct ScanInWork {
  std::unique_ptr<Derivation> files;
  ScanWork work;
  RowLayout layout = {};  // what was known of the block up to it
  ScanVoxels voxels = {};
  ProcessedScan processed = {};
  bool as_it_was = false;  // an earlier run has left all that would be made
  ScanReport report = {};
};

void report_plants(ScanInWork& scan) {
  scan.report.scan_id = scan.work.scan.scan_id;
  scan.report.rays = scan.work.scan.ray_count;
  const ScanTotals& totals = scan.processed.totals;
  scan.report.plant_area_m2 =
      totals.panels_with_value > 0 ? totals.plant_area_m2 : std::numeric_limits<double>::quiet_NaN();
  scan.report.panels = totals.panels, scan.report.panels_with_value = totals.panels_with_value;
  scan.report.observed_fraction = totals.observed_fraction;
  scan.report.leaf_size_m2 = scan.processed.leaf_size_m2;
  scan.report.voxel_m = scan.processed.voxel_m;
}

// The full echo and how large leaves look go with the angles at which rays meet them.
void take_leaf_angles(ScanVoxels& voxels) {
  if (voxels.echoes) voxels.echoes = with_aspect(*voxels.echoes, voxels.leaf_angles.aspect);
}

// Whether an earlier run has made all of the scan's plants. Reads next to nothing of it.
Result<bool> find_plants(ScanInWork& scan, BlockRegistry& registry) {
  const tile::ScanEntry& entry = scan.work.scan;
  const std::optional<std::string> key = processed_key(scan.work.options, entry, registry);
  if (!key) return false;
  RAYFIELD_ASSIGN(const auto processed, find_processed(scan.work, *key));
  if (!processed) return false;
  RAYFIELD_ASSIGN(scan.voxels.echoes, read_echoes(scan.work.store, entry));
  RAYFIELD_ASSIGN(scan.voxels.leaf_angles, read_leaf_angles(scan.work.store, entry));
  scan.voxels.rows_from_one_side = processed->rows_from_one_side;
  take_leaf_angles(scan.voxels);
  scan.layout = registry.layout_for(entry);
  scan.processed = *processed;
  report_plants(scan);
  return true;
}

// One scan, from its rays to the maps of its plants. Finds the block's layout on the way if there is none yet.
Result<void> process_plants(ScanInWork& scan, tile::Store::DerivedWriter& writer, BlockRegistry& registry) {
  ScanWork& work = scan.work;
  RAYFIELD_ASSIGN(const SurveyedScan surveyed, survey_scan(work));
  if (!registry.known()) RAYFIELD_CHECK(registry.adopt(work, surveyed, writer));
  const RowLayout known = registry.known_before(work.scan);
  RAYFIELD_CHECK(registry.take_evidence(work, surveyed));
  scan.layout = registry.layout_for(work.scan);
  const RowLayout& layout = scan.layout;
  work.layout_key = geometry_key(layout);
  work.voxels = work.options.voxels;
  const bool counts_all = surveyed.survey.holds_downward_misses();
  if (counts_all) work.voxels.sure_return_m = 0;

  scan.voxels.wood = wood_of(layout, surveyed.ground);
  scan.voxels.rows_from_one_side = rows_from_one_side(layout, surveyed.survey.path(), work.options.rows);
  RAYFIELD_ASSIGN(const CanopyProfile profile, profile_canopy(work, layout, surveyed.ground));
  // The published method counts every echo.
  const bool counts_echoes = work.options.estimator.estimator == Estimator::paper;
  auto view = counts_echoes ? nullptr : view_of(work.scan, surveyed.survey, work.options.beam);
  RAYFIELD_ASSIGN(scan.voxels.echoes, measure_echoes(work, layout, surveyed, profile, scan.voxels.wood, view));
  view = view_with(view, scan.voxels.echoes);
  RAYFIELD_ASSIGN(scan.voxels.leaf_angles, measure_leaf_angles(work, layout, surveyed.ground, profile, scan.voxels.wood,
                                                               view, scan.voxels.echoes));
  take_leaf_angles(scan.voxels);
  if (work.voxels.leaf_angles.type == LeafAngleType::measured)
    work.voxels.leaf_angles = scan.voxels.leaf_angles.angles();
  RAYFIELD_ASSIGN(const double voxel_m,
                  choose_voxel_size(work, layout, surveyed.ground, profile, scan.voxels.wood, scan.voxels.echoes));
  RAYFIELD_ASSIGN(scan.voxels.row_segments, cut_row_segments(work, layout, surveyed.ground, profile, voxel_m));
  RAYFIELD_ASSIGN(scan.voxels.tiles,
                  count_voxels(work, {work.scan, work.voxels, "", view, /*pairs=*/!scan.voxels.echoes},
                               scan.voxels.row_segments, scan.voxels.wood));
  RAYFIELD_ASSIGN(const ScanResults results, integrate_scan(work, layout, surveyed, scan.voxels));
  RAYFIELD_CHECK(keep_estimation(work, scan.voxels.wood));
  scan.processed.leaf_size_m2 = results.leaf_size_m2;
  scan.processed.voxel_m = voxel_m;
  scan.processed.rows_from_one_side = scan.voxels.rows_from_one_side;
  RAYFIELD_ASSIGN(scan.processed.totals, total_scan(work, layout, results, counts_all));
  report_plants(scan);
  return keep_processed(work, processed_key(work.options, work.scan, known, layout), scan.processed);
}

// Files of a scan that is as it was are taken; for another wood its plants are needed after all.
Result<void> take_or_make_plants(const tile::Store& store, ScanInWork& scan, const BlockSeasons& seasons,
                                 tile::Store::DerivedWriter& writer, BlockRegistry& registry) {
  if (!scan.as_it_was) return {};
  RAYFIELD_ASSIGN(const bool other_wood, seasons.is_outdated(store, scan.work.scan));
  scan.as_it_was = !other_wood;
  if (other_wood) return process_plants(scan, writer, registry);
  for (const tile::DerivedEntry& entry : scan.work.scan.derived) scan.files->take(entry);
  return {};
}

void report_leaves(const LeafReport& leaves, ScanReport& report) {
  if (report.panels_with_value == 0) return;
  report.leaf_area_m2 = leaves.leaf_area_m2;
  report.leaf_low_m2 = leaves.low_m2, report.leaf_high_m2 = leaves.high_m2;
}

// Where no dormant scan shows the wood.
Result<void> process_leaves_by_estimate(ScanInWork& scan, const std::optional<BarestScan>& barest) {
  ScanReport& report = scan.report;
  if (!scan.work.options.wood.enabled) {
    report.notes.emplace_back(kWoodInLeafArea);
    return {};
  }
  RAYFIELD_ASSIGN(const LeafReport leaves,
                  scan.as_it_was ? read_leaves(scan.work, scan.layout)
                                 : separate_leaves_by_estimate(scan.work, scan.layout, scan.voxels, barest));
  report_leaves(leaves, report);
  report.wood_from = kWoodFromEstimate;
  report.notes.emplace_back(kWoodIsEstimated);
  if (barest)
    report.notes.push_back(
        fmt::format("wood is taken to be no more than what {} shows, the barest scan of the season", barest->scan_id));
  if (report.leaf_area_m2 && leaves.low_m2 <= 0)
    report.notes.emplace_back(
        "what is seen may be wood alone; if the vines bore no leaves, say so: `rayfield add … --dormant yes`");
  return {};
}

// The wood is seen as the leaves are, so that what is alike in both cancels.
VoxelOptions voxels_for_wood(const ScanInWork& scan) {
  VoxelOptions voxels = scan.work.options.voxels;
  if (voxels.leaf_angles.type == LeafAngleType::measured) voxels.leaf_angles = scan.voxels.leaf_angles.angles();
  return voxels;
}

// Its leaves; what is noteworthy about them goes into the report.
Result<void> process_leaves(ScanInWork& scan, const BlockSeasons& seasons) {
  const std::string& scan_id = scan.work.scan.scan_id;
  std::vector<std::string>& notes = scan.report.notes;
  if (const std::string note = beam_note(scan.work.scan, scan.voxels.echoes); !note.empty()) notes.push_back(note);
  if (const std::string note = leaf_angle_note(scan.work.scan, scan.voxels.leaf_angles); !note.empty())
    notes.push_back(note);
  if (const std::string note = one_side_note(scan.work.scan, scan.layout, scan.voxels.rows_from_one_side);
      !note.empty())
    notes.push_back(note);
  const std::string verdict = seasons.verdict_on(scan_id);
  if (!verdict.empty()) notes.push_back(scan_id + " " + verdict);
  const auto wood = seasons.wood_for(scan_id, voxels_for_wood(scan));
  if (!wood) return process_leaves_by_estimate(scan, seasons.barest_for(scan_id));
  RAYFIELD_ASSIGN(const LeafReport leaves, scan.as_it_was
                                               ? read_leaves(scan.work, scan.layout)
                                               : separate_leaves(scan.work, scan.layout, scan.voxels, *wood));
  report_leaves(leaves, scan.report);
  scan.report.wood_scan_id = wood->scan.scan_id, scan.report.wood_from = kWoodFromDormantScan;
  if (leaves.without_wood > 0)
    notes.push_back(fmt::format("{} of {} panels have no leaf area: the dormant scan {} does not show their wood",
                                leaves.without_wood, leaves.panels, wood->scan.scan_id));
  return {};
}

// Failures that another scan need not share. Of the rest, a full disk is one.
bool is_of_one_scan(ErrorCode code) {
  return code == ErrorCode::usage || code == ErrorCode::bad_input || code == ErrorCode::damaged;
}

Error with_scan(Error error, const std::string& scan_id) {
  if (error.where.find(scan_id) == std::string::npos)
    error.where = error.where.empty() ? scan_id : scan_id + ", " + error.where;
  return error;
}

// What of a scan comes before the wood of another is subtracted.
Result<void> begin_scan(ScanInWork& scan, tile::Store::DerivedWriter& writer, BlockRegistry& registry) {
  RAYFIELD_ASSIGN(scan.as_it_was, find_plants(scan, registry));
  if (scan.as_it_was) return {};
  return process_plants(scan, writer, registry);
}

// Scans outside this run whose leaf areas differ from what a run over all scans would give.
Result<std::vector<std::string>> find_outdated(const tile::Store& store, const tile::Snapshot& snapshot,
                                               const std::list<ScanInWork>& scans,
                                               const std::vector<FailedScan>& failed, const BlockSeasons& seasons) {
  std::vector<std::string> outdated;
  for (const tile::ScanEntry& entry : snapshot.scans) {
    bool in_work = std::any_of(failed.begin(), failed.end(),
                               [&](const FailedScan& scan) { return scan.scan_id == entry.scan_id; });
    for (const ScanInWork& scan : scans) in_work = in_work || scan.work.scan.scan_id == entry.scan_id;
    if (in_work) continue;
    RAYFIELD_ASSIGN(const bool other_wood, seasons.is_outdated(store, entry));
    if (other_wood) outdated.push_back(entry.scan_id);
  }
  return outdated;
}

}  // namespace

Result<ProcessReport> process(tile::Store& store, const ProcessOptions& options, const std::string& command,
                              Progress& progress) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(tile::Store::DerivedWriter writer, store.write_derived());
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const std::vector<std::string> scan_ids, scans_to_process(store, snapshot, options.dates));
  RAYFIELD_ASSIGN(BlockRegistry registry, BlockRegistry::open(store, snapshot, options));

  ProcessReport report;
  report.layout_is_new = !registry.known();
  std::list<ScanInWork> scans;
  std::map<std::string, ScanTotals> totals;
  for (const std::string& scan_id : scan_ids) {
    auto files = std::make_unique<Derivation>(store, writer, scan_id, options.redo);
    ScanWork work{store, *snapshot.find_scan(scan_id), options, *files, progress};
    ScanInWork& scan = scans.emplace_back(ScanInWork{std::move(files), std::move(work)});
    if (auto begun = begin_scan(scan, writer, registry); !begun) {
      report.failed.push_back({scan_id, with_scan(std::move(begun).error(), scan_id)});
      if (!is_of_one_scan(report.failed.back().error.code)) return tl::make_unexpected(report.failed.back().error);
      registry.forget(scan_id);
      scans.pop_back();
      continue;
    }
    totals[scan_id] = scan.processed.totals;
  }
  if (scans.empty()) return tl::make_unexpected(report.failed.front().error);
  RAYFIELD_ASSIGN(const BlockSeasons seasons, BlockSeasons::read(store, snapshot, totals, options.wood.enabled));
  for (ScanInWork& scan : scans) {
    RAYFIELD_CHECK(take_or_make_plants(store, scan, seasons, writer, registry));
    RAYFIELD_CHECK(process_leaves(scan, seasons));
    RAYFIELD_CHECK(scan.files->finish());
    scan.report.files_made = scan.files->total().made, scan.report.files_kept = scan.files->total().kept;
    report.scans.push_back(scan.report);
  }
  RAYFIELD_ASSIGN(report.outdated_leaf_areas, find_outdated(store, snapshot, scans, report.failed, seasons));
  RAYFIELD_ASSIGN(const RowLayout layout, registry.finish(writer));
  RAYFIELD_CHECK(writer.commit(command));
  report.rows = layout.rows.size();
  report.panels = layout.panels.size();
  report.posts = layout.posts.size();
  report.notes = registry.notes();
  return report;
}

}  // namespace rayfield::density
