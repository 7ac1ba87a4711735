#include "libdensity/scan/scan_voxel_size.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "libdensity/scan/scan_voxels.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"
#include "libdensity/voxels/voxel_grid.h"

namespace rayfield::density {
namespace {

// Neighbouring beams on one tile. Sums of integers, so that their order does not matter.
Result<LeafSizePairs> pairs_of_tile(ScanWork& work, const tile::TileEntry& entry, VoxelAccumulator empty) {
  RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
  const auto add_pairs = [](VoxelAccumulator& sum, const tile::SegmentBatch& rays) { sum.add_pairs(rays); };
  RAYFIELD_ASSIGN(VoxelAccumulator sum,
                  accumulate_tile(reader, std::move(empty), work.threads, work.progress, add_pairs));
  return std::move(sum).finish().pairs;
}

Result<LeafSizePairs> pairs_of_scan(ScanWork& work, const RowSegmentList& row_segments,
                                    std::span<const WoodCylinder> wood) {
  LeafSizePairs pairs;
  work.progress.stage(fmt::format("{}: leaf size", work.scan.scan_id), work.scan.tiles.size(), "tiles");
  for (const tile::TileEntry& entry : work.scan.tiles) {
    work.progress.advance(1);
    const TileScene scene = scene_of(work.tile_of(entry), work.store.config().tile_margin_m, row_segments, wood);
    if (scene.row_segments.empty()) continue;
    RAYFIELD_ASSIGN(VoxelAccumulator empty,
                    VoxelAccumulator::create(work.tile_of(entry), scene.row_segments, scene.wood, work.voxels));
    if (empty.empty()) continue;
    RAYFIELD_ASSIGN(const LeafSizePairs here, pairs_of_tile(work, entry, std::move(empty)));
    pairs += here;
  }
  return pairs;
}

double fitted_size(double leaf_size_m2, const VoxelFitOptions& options) {
  // Whole millimetres: finer than the leaves are known, and no step between drives that see them a little different.
  const double side = std::round(options.leaf_sides * std::sqrt(leaf_size_m2) * 1000) / 1000;
  return std::clamp(side, options.min_m, options.max_m);
}

}  // namespace

Result<double> choose_voxel_size(ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                                 const CanopyProfile& profile, std::span<const WoodCylinder> wood) {
  const VoxelFitOptions& fit = work.options.voxel_fit;
  if (!fit.enabled) return work.options.segments.voxel_m;
  if (work.options.estimator.leaf_size_m2 > 0) return fitted_size(work.options.estimator.leaf_size_m2, fit);
  KeyBuilder key("voxelsize", kVoxelSizeVersion);
  key.add(option_numbers(work.options.segments));
  key.add(option_numbers(work.voxels));
  key.add(option_numbers(fit)).add(work.layout_key).add(work.files.sha256("profile", "block"));
  for (const tile::TileEntry& entry : work.scan.tiles)
    key.add(entry.content_sha256()).add(work.files.sha256("ground", tile_name(entry.index)));
  const auto make = [&]() -> Result<tile::ArraySet> {
    RAYFIELD_ASSIGN(const RowSegmentList row_segments,
                    make_row_segmentes(layout, ground, profile, with_voxel_size(work.options.segments, fit.sample_m)));
    RAYFIELD_ASSIGN(const LeafSizePairs pairs, pairs_of_scan(work, row_segments, wood));
    tile::ArraySet arrays{.kind = "voxelsize", .attributes = "{}"};
    arrays.columns["voxel_m"] = std::vector<double>{fitted_size(estimate_leaf_size(pairs).area_m2, fit)};
    return arrays;
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get("voxelsize", "block", key.hex(), make));
  RAYFIELD_ASSIGN(const auto column, arrays.column<double>("voxel_m"));
  if (column.size() != 1)
    return fail(ErrorCode::damaged, "cannot read derived data", "voxelsize", "it has no single value",
                "run `rayfield verify`");
  return column[0];
}

}  // namespace rayfield::density
