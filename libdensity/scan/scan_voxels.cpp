#include "libdensity/scan/scan_voxels.h"

#include <fmt/core.h>

#include "libdensity/scan/lazy_stage.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"
#include "libdensity/voxels/voxel_accumulator.h"
#include "libdensity/voxels/voxel_arrays.h"

namespace rayfield::density {
namespace {

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

// The track follows from the rays of all tiles.
void add_view(KeyBuilder& key, const BeamView& view, const tile::ScanEntry& scan) {
  key.add(view.beam.diameter_m).add(view.beam.divergence_rad).add(view.behind_m).add(view.followed_m);
  for (const tile::TileEntry& entry : scan.tiles) key.add(entry.content_sha256());
}

Result<TileVoxels> count_tile(ScanWork& work, const tile::TileEntry& entry, VoxelAccumulator empty, bool pairs) {
  if (!pairs) empty.leave_out_pairs();
  RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
  RAYFIELD_ASSIGN(const int workers, counting_workers(work, entry.index, empty));
  RAYFIELD_ASSIGN(VoxelAccumulator sum, accumulate_tile(reader, std::move(empty), workers, work.progress));
  return std::move(sum).finish();
}

}  // namespace

Result<int> counting_workers(const ScanWork& work, tile::TileIndex tile, const VoxelAccumulator& empty) {
  // Twice: beside the copies there are the empty counters at first and the columns that are stored at last.
  return workers_within(work.memory.counts_bytes, 2 * empty.bytes(), work.threads, work.options,
                        work.scan.scan_id + ", tile " + tile_name(tile));
}

TileScene scene_of(const tile::TileRef& tile, double margin_m, const RowSegmentList& list,
                   std::span<const WoodCylinder> wood) {
  const Eigen::Vector2d low = tile.corner();
  Eigen::AlignedBox2d square(Eigen::Vector2d(low.array() - margin_m),
                             Eigen::Vector2d(low.array() + tile.size_m + margin_m));
  TileScene scene;
  for (const RowSegment& row_segment : list.row_segments)
    if (square.intersects(bounds_of(row_segment))) scene.row_segments.push_back(row_segment);
  for (const WoodCylinder& cylinder : wood)
    if (square.exteriorDistance(Eigen::Vector2d(cylinder.base.head<2>())) < cylinder.length_m)
      scene.wood.push_back(cylinder);
  return scene;
}

Result<void> for_voxel_tiles(ScanWork& work, std::span<const tile::TileEntry> tiles, const RowSegmentList& row_segments,
                             std::span<const WoodCylinder> wood, const std::shared_ptr<const BeamView>& view,
                             const std::function<Result<void>(const tile::TileEntry&, VoxelAccumulator)>& visit) {
  for (const tile::TileEntry& entry : tiles) {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    work.progress.advance(1);
    const TileScene scene = scene_of(work.tile_of(entry), work.store.config().tile_margin_m, row_segments, wood);
    if (scene.row_segments.empty()) continue;
    RAYFIELD_ASSIGN(VoxelAccumulator empty,
                    VoxelAccumulator::create(work.tile_of(entry), scene.row_segments, scene.wood, work.voxels, view));
    if (!empty.empty()) RAYFIELD_CHECK(visit(entry, std::move(empty)));
  }
  return {};
}

Result<std::vector<tile::TileIndex>> count_voxels(ScanWork& work, const CountedRays& rays,
                                                  const RowSegmentList& row_segments,
                                                  std::span<const WoodCylinder> wood) {
  std::vector<tile::TileIndex> with_voxels;
  const bool own = rays.scan.scan_id == work.scan.scan_id;
  LazyStage stage(work.progress,
                  fmt::format("{}: {}", work.scan.scan_id, own ? "voxels" : "wood of " + rays.scan.scan_id),
                  rays.scan.ray_count, "rays");
  for (const tile::TileEntry& entry : rays.scan.tiles) {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    const TileScene scene = scene_of(work.tile_of(entry), work.store.config().tile_margin_m, row_segments, wood);
    stage.advance(entry.start_count);
    if (scene.row_segments.empty()) continue;
    RAYFIELD_ASSIGN(VoxelAccumulator empty, VoxelAccumulator::create(work.tile_of(entry), scene.row_segments,
                                                                     scene.wood, rays.voxels, rays.view));
    if (empty.empty()) continue;
    KeyBuilder key("voxels", kVoxelsVersion);
    key.add(option_numbers(rays.voxels)).add(entry.content_sha256()).add(rays.pairs ? 1.0 : 0.0);
    for (const RowSegment& row_segment : scene.row_segments) add_row_segment(key, row_segment);
    for (const WoodCylinder& cylinder : scene.wood) add_wood(key, cylinder);
    if (rays.view) add_view(key, *rays.view, rays.scan);
    const std::string name = rays.prefix + tile_name(entry.index);
    RAYFIELD_CHECK(work.files.get("voxels", name, key.hex(), [&]() -> Result<tile::ArraySet> {
      stage.begin();
      RAYFIELD_ASSIGN(const TileVoxels voxels, count_tile(work, entry, std::move(empty), rays.pairs));
      return arrays_from_voxels(voxels);
    }));
    with_voxels.push_back(entry.index);
  }
  return with_voxels;
}

}  // namespace rayfield::density
