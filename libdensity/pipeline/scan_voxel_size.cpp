#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "libdensity/pipeline/option_keys.h"
#include "libdensity/pipeline/scan_stages.h"
#include "rayfield/core/parallel.h"

namespace rayfield::density {
namespace {

constexpr int kVoxelSizeVersion = 3;

// Neighbouring beams on one tile. Sums of integers, so that their order does not matter.
Result<LeafSizePairs> pairs_of_tile(ScanWork& work, const tile::TileEntry& entry, VoxelAccumulator empty) {
  RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
  const std::size_t chunks = reader.chunk_count();
  const auto workers = static_cast<std::size_t>(std::max(1, std::min<int>(work.threads, static_cast<int>(chunks))));
  std::vector<VoxelAccumulator> parts;
  for (std::size_t w = 1; w < workers; ++w) parts.push_back(empty.fork());
  parts.push_back(std::move(empty));
  std::vector<tile::SegmentBatch> batches(workers);
  RAYFIELD_CHECK(parallel_for(chunks, static_cast<int>(workers), [&](std::size_t chunk, int worker) -> Result<void> {
    const auto w = static_cast<std::size_t>(worker);
    RAYFIELD_CHECK(check_cancelled(work.progress));
    RAYFIELD_CHECK(reader.read_chunk(chunk, batches[w]));
    parts[w].add_pairs(batches[w]);
    return {};
  }));
  for (std::size_t w = 1; w < parts.size(); ++w) RAYFIELD_CHECK(parts[0].merge(parts[w]));
  return std::move(parts[0]).finish().pairs;
}

Result<LeafSizePairs> pairs_of_scan(ScanWork& work, const RowSegmentList& row_segments,
                                    std::span<const WoodCylinder> wood) {
  LeafSizePairs pairs;
  work.progress.stage(fmt::format("{}: leaf size", work.scan.scan_id), work.scan.tiles.size(), "tiles");
  for (const tile::TileEntry& entry : work.scan.tiles) {
    work.progress.advance(1);
    const TileScene scene =
        scene_of(entry.index, work.tile_size_m(), work.store.config().tile_margin_m, row_segments, wood);
    if (scene.row_segments.empty()) continue;
    RAYFIELD_ASSIGN(VoxelAccumulator empty, VoxelAccumulator::create(entry.index, work.tile_size_m(),
                                                                     scene.row_segments, scene.wood, work.voxels));
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
  add_options(key, work.options.segments);
  add_options(key, work.voxels);
  add_options(key, fit).add(work.layout_key).add(work.files.sha256("profile", "block"));
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
