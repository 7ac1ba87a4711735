#include "rayfield/density/process.h"

#include <cmath>

#include "libdensity/pipeline/layout_store.h"
#include "libdensity/pipeline/scan_products.h"
#include "libdensity/pipeline/scan_stages.h"
#include "libdensity/pipeline/scan_voxel_size.h"
#include "libdensity/pipeline/scan_voxels.h"
#include "rayfield/core/parallel.h"
#include "rayfield/density/load.h"

namespace rayfield::density {
namespace {

// One scan, from its rays to its maps. Finds the block's layout on the way if there is none yet.
Result<ScanReport> process_scan(const tile::Store& store, tile::Store::DerivedWriter& writer,
                                const tile::ScanEntry& scan, const ProcessOptions& options, BlockLayout& block,
                                Progress& progress) {
  Derivation files(store, writer, scan.scan_id, options.redo);
  ScanWork work{store, scan, options, files, progress, thread_count(options.threads)};
  RAYFIELD_ASSIGN(const SurveyedScan surveyed, survey_scan(work));
  if (!block.known) RAYFIELD_CHECK(adopt_layout(work, surveyed, writer, block));
  work.layout_key = block.key;
  work.voxels = options.voxels;
  if (holds_downward_misses(surveyed.surveys)) work.voxels.sure_return_m = 0;

  const std::vector<WoodCylinder> wood = wood_of(block.layout, surveyed.ground);
  RAYFIELD_ASSIGN(const CanopyProfile profile, profile_canopy(work, block.layout, surveyed.ground));
  RAYFIELD_ASSIGN(const double voxel_m, choose_voxel_size(work, block.layout, surveyed.ground, profile, wood));
  RAYFIELD_ASSIGN(const RowSegmentList row_segments,
                  cut_row_segmentes(work, block.layout, surveyed.ground, profile, voxel_m));
  RAYFIELD_ASSIGN(const auto tiles, count_voxels(work, row_segments, wood));
  ScanReport report;
  report.scan_id = scan.scan_id;
  report.rays = scan.ray_count;
  RAYFIELD_ASSIGN(const ScanResults results, integrate_scan(work, block.layout, surveyed, row_segments, wood, tiles));
  for (const PanelValue& value : results.panel_values)
    if (std::isfinite(value.plant_area_m2)) report.plant_area_m2 += value.plant_area_m2;
  report.leaf_size_m2 = results.element_area_m2;
  report.voxel_m = voxel_m;
  RAYFIELD_CHECK(files.finish());
  report.files_made = files.total().made, report.files_kept = files.total().kept;
  return report;
}

}  // namespace

Result<ProcessReport> process(tile::Store& store, const ProcessOptions& options, const std::string& command,
                              Progress& progress) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(tile::Store::DerivedWriter writer, store.write_derived());
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  if (snapshot.scans.empty())
    return fail(ErrorCode::usage, "nothing to process", store.folder().string(), "the store holds no scan yet",
                "add one with `rayfield add`");
  RAYFIELD_ASSIGN(const std::vector<std::string> scan_ids, select_scans(snapshot, options.dates));
  RAYFIELD_ASSIGN(BlockLayout block, load_layout(store, snapshot, options));

  ProcessReport report;
  report.layout_is_new = !block.known;
  for (const std::string& scan_id : scan_ids) {
    RAYFIELD_ASSIGN(ScanReport scan,
                    process_scan(store, writer, *snapshot.find_scan(scan_id), options, block, progress));
    report.scans.push_back(std::move(scan));
  }
  RAYFIELD_CHECK(writer.commit(command));
  report.rows = block.layout.rows.size();
  report.panels = block.layout.panels.size();
  report.posts = block.layout.posts.size();
  report.notes = block.notes;
  return report;
}

}  // namespace rayfield::density
