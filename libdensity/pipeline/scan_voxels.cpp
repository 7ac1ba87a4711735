#include <fmt/core.h>

#include "libdensity/pipeline/option_keys.h"
#include "libdensity/pipeline/scan_stages.h"
#include "libdensity/tiles/chunks.h"
#include "rayfield/density/voxel_arrays.h"

namespace rayfield::density {
namespace {

constexpr int kVoxelsVersion = 2;

// Corners of a row segment's grid in plan, m.
Eigen::AlignedBox2d bounds_of(const RowSegment& s) {
  Eigen::AlignedBox2d box;
  const Eigen::Vector2d left(-s.direction.y(), s.direction.x());
  for (const int along : {0, s.n_along})
    for (const int across : {0, s.n_across})
      box.extend(
          Eigen::Vector2d(s.origin + along * s.voxel_m * s.direction + (s.across_min_m + across * s.voxel_m) * left));
  return box;
}

void add_row_segment(KeyBuilder& key, const RowSegment& s) {
  key.add(std::vector<double>{static_cast<double>(s.row), static_cast<double>(s.index), s.origin.x(), s.origin.y(),
                              s.direction.x(), s.direction.y(), s.chainage_m, s.ground_m, s.slope_along, s.slope_across,
                              static_cast<double>(s.first_along), static_cast<double>(s.n_along),
                              static_cast<double>(s.n_across), static_cast<double>(s.n_up), s.across_min_m, s.up_min_m,
                              s.voxel_m});
}

void add_wood(KeyBuilder& key, const WoodCylinder& w) {
  key.add(std::vector<double>{static_cast<double>(w.row), w.base.x(), w.base.y(), w.base.z(), w.axis.x(), w.axis.y(),
                              w.axis.z(), w.radius_m, w.length_m, w.bend_m});
}

Result<TileVoxels> count_tile(ScanWork& work, const tile::TileEntry& entry, VoxelAccumulator empty) {
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
    return parts[w].add(batches[w]);
  }));
  for (std::size_t w = 1; w < parts.size(); ++w) RAYFIELD_CHECK(parts[0].merge(parts[w]));
  return std::move(parts[0]).finish();
}

}  // namespace

TileScene scene_of(tile::TileIndex index, double tile_size_m, double margin_m, const RowSegmentList& list,
                   std::span<const WoodCylinder> wood) {
  const Eigen::Vector2d low(index.ix * tile_size_m, index.iy * tile_size_m);
  Eigen::AlignedBox2d square(Eigen::Vector2d(low.array() - margin_m),
                             Eigen::Vector2d(low.array() + tile_size_m + margin_m));
  TileScene scene;
  for (const RowSegment& row_segment : list.row_segments)
    if (square.intersects(bounds_of(row_segment))) scene.row_segments.push_back(row_segment);
  for (const WoodCylinder& cylinder : wood)
    if (square.exteriorDistance(Eigen::Vector2d(cylinder.base.head<2>())) < cylinder.length_m)
      scene.wood.push_back(cylinder);
  return scene;
}

Result<std::vector<tile::TileIndex>> count_voxels(ScanWork& work, const RowSegmentList& row_segments,
                                                  std::span<const WoodCylinder> wood) {
  std::vector<tile::TileIndex> with_voxels;
  work.progress.stage(fmt::format("{}: voxels", work.scan.scan_id), work.scan.ray_count, "rays");
  for (const tile::TileEntry& entry : work.scan.tiles) {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    const TileScene scene =
        scene_of(entry.index, work.tile_size_m(), work.store.config().tile_margin_m, row_segments, wood);
    work.progress.advance(entry.start_count);
    if (scene.row_segments.empty()) continue;
    RAYFIELD_ASSIGN(VoxelAccumulator empty, VoxelAccumulator::create(entry.index, work.tile_size_m(),
                                                                     scene.row_segments, scene.wood, work.voxels));
    if (empty.empty()) continue;
    KeyBuilder key("voxels", kVoxelsVersion);
    add_options(key, work.voxels).add(entry.content_sha256());
    for (const RowSegment& row_segment : scene.row_segments) add_row_segment(key, row_segment);
    for (const WoodCylinder& cylinder : scene.wood) add_wood(key, cylinder);
    RAYFIELD_CHECK(work.files.get("voxels", tile_name(entry.index), key.hex(), [&]() -> Result<tile::ArraySet> {
      RAYFIELD_ASSIGN(const TileVoxels voxels, count_tile(work, entry, std::move(empty)));
      return arrays_from_voxels(voxels);
    }));
    with_voxels.push_back(entry.index);
  }
  return with_voxels;
}

}  // namespace rayfield::density
