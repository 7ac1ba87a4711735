#include "rayfield/density/voxel_cloud.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "libdensity/cloud/hit_locator.h"
#include "libdensity/cloud/voxel_densities.h"
#include "libdensity/scan/estimation.h"
#include "libdensity/scan/row_voxels.h"
#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/scan_leaf_angles.h"
#include "libdensity/scan/scan_voxels.h"
#include "libdensity/tiles/accumulate.h"
#include "libdensity/voxels/row_segment_arrays.h"
#include "rayfield/core/parallel.h"

namespace rayfield::density {
namespace {

const tile::DerivedEntry* find_derived(const tile::ScanEntry& scan, std::string_view kind, std::string_view name) {
  for (const tile::DerivedEntry& entry : scan.derived)
    if (entry.kind == kind && entry.name == name) return &entry;
  return nullptr;
}

tl::unexpected<Error> not_processed(const tile::ScanEntry& scan) {
  return fail(ErrorCode::usage, "no densities of voxels", scan.scan_id, "it has not been processed",
              "run `rayfield process` first");
}

Result<RowSegmentList> read_row_segments(const tile::Store& store, const tile::ScanEntry& scan) {
  const tile::DerivedEntry* entry = find_derived(scan, "stretches", "block");
  if (entry == nullptr) return not_processed(scan);
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(*entry));
  return row_segments_from_arrays(arrays);
}

// The counters of a scan's own rays, tile by tile.
Result<RowVoxels> open_voxels(const tile::Store& store, const tile::ScanEntry& scan, std::size_t bytes) {
  std::vector<tile::TileIndex> tiles;
  for (const tile::TileEntry& entry : scan.tiles)
    if (find_derived(scan, "voxels", tile_name(entry.index)) != nullptr) tiles.push_back(entry.index);
  const auto read = [&store, &scan](const std::string& name) -> Result<tile::ArraySet> {
    const tile::DerivedEntry* entry = find_derived(scan, "voxels", name);
    if (entry == nullptr) return not_processed(scan);
    return store.read_derived(*entry);
  };
  return RowVoxels::open(read, "", tiles, bytes);
}

}  // namespace

struct VoxelCloud::Impl {
  const tile::Store& store;
  const tile::ScanEntry& scan;
  VoxelCloudOptions options;
  Estimation estimation;
  VoxelDensities densities;
  RowSegmentList row_segments = {};                       // of the densities, in their order
  std::map<std::pair<int, int>, std::size_t> place = {};  // in them, by row and index

  ProcessOptions process_options() const {
    ProcessOptions out;
    out.threads = options.threads, out.memory_bytes = options.memory_bytes;
    return out;
  }
  Result<void> estimate(Progress& progress);
  Result<HitLocator::Scene> scene_of_tile(const tile::TileRef& tile) const;
  Result<void> pass_tile(const tile::TileEntry& entry, HitLocator::Scene scene, const Progress& progress,
                         const std::function<Result<void>(const DensityPoints&)>& take) const;
};

// As process() does: rows in parallel, as many as have room, brought together in their order.
Result<void> VoxelCloud::Impl::estimate(Progress& progress) {
  const ProcessOptions process = process_options();
  RAYFIELD_ASSIGN(const RowSegmentList list, read_row_segments(store, scan));
  RAYFIELD_ASSIGN(std::optional<EchoModel> echoes, read_echoes(store, scan));
  RAYFIELD_ASSIGN(const LeafAngleFit leaf_angles, read_leaf_angles(store, scan));
  if (echoes) echoes = with_aspect(*echoes, leaf_angles.aspect);
  RAYFIELD_ASSIGN(RowVoxels counters, open_voxels(store, scan, ProcessMemory(process).tiles_bytes));
  std::set<int> numbers;
  for (const RowSegment& s : list.row_segments)
    if (counters.has_row(s.row)) numbers.insert(s.row);
  const std::vector<int> rows(numbers.begin(), numbers.end());
  progress.stage(fmt::format("{}: density", scan.scan_id), rows.size(), "rows");
  RAYFIELD_ASSIGN(const int workers, rows_in_hand(process, scan.scan_id, list, echoes.has_value()));
  std::vector<std::optional<RowDensity>> done(rows.size());
  const auto make = [&](std::size_t i, int) -> Result<void> {
    RAYFIELD_CHECK(check_cancelled(progress));
    RAYFIELD_ASSIGN(done[i], counters.density(rows[i], list, estimation.wood, estimation.estimator, echoes));
    return {};
  };
  const auto keep = [&](std::size_t i) -> Result<void> {
    const std::optional<RowDensity> row = std::exchange(done[i], {});
    progress.advance(1);
    return densities.add(*row);
  };
  RAYFIELD_CHECK(parallel_ordered(rows.size(), workers, static_cast<std::size_t>(workers), make, keep));
  for (const SegmentDensities& s : densities.segments()) {
    place[{s.row_segment.row, s.row_segment.index}] = row_segments.row_segments.size();
    row_segments.row_segments.push_back(s.row_segment);
  }
  return {};
}

Result<HitLocator::Scene> VoxelCloud::Impl::scene_of_tile(const tile::TileRef& tile) const {
  const TileScene near = scene_of(tile, 0, row_segments, estimation.wood);
  HitLocator::Scene scene{{}, {}, near.wood, estimation.wood_shell_m};
  for (const RowSegment& s : near.row_segments) {
    const SegmentDensities& segment = densities.segments()[place.at({s.row, s.index})];
    std::vector<float> values(segment.stored_shape().size());
    RAYFIELD_CHECK(densities.read(segment.first, values));
    scene.segments.push_back(segment);
    scene.values.push_back(std::move(values));
  }
  return scene;
}

// Chunks are looked through in parallel and passed on in their order.
Result<void> VoxelCloud::Impl::pass_tile(const tile::TileEntry& entry, HitLocator::Scene scene,
                                         const Progress& progress,
                                         const std::function<Result<void>(const DensityPoints&)>& take) const {
  const HitLocator locator(std::move(scene), {entry.index, store.config().tile_size_m});
  RAYFIELD_ASSIGN(const auto reader, store.open_tile(entry));
  const int workers = std::min(chunk_workers(reader, options.threads), ProcessMemory(process_options()).threads);
  struct Hand {
    tile::SegmentBatch segments;
    HitLocator::Mask mask;
  };
  std::vector<Hand> hands(static_cast<std::size_t>(workers), Hand{{}, locator.mask()});
  std::vector<DensityPoints> found(reader.chunk_count());
  const auto look = [&](std::size_t chunk, int worker) -> Result<void> {
    RAYFIELD_CHECK(check_cancelled(progress));
    auto& [segments, mask] = hands[static_cast<std::size_t>(worker)];
    RAYFIELD_CHECK(reader.read_chunk(chunk, segments));
    constexpr int kWanted = tile::kHit | tile::kEndsHere;
    for (std::size_t i = 0; i < segments.size(); ++i) {
      if ((segments.flags[i] & kWanted) != kWanted) continue;
      const auto hit = locator.find(segments.exit[i], mask);
      if (!hit) continue;
      DensityPoints& points = found[chunk];
      points.position.push_back(segments.exit[i]), points.time_s.push_back(segments.time_s[i]);
      points.intensity.push_back(segments.intensity[i]);
      points.density.push_back(hit->density), points.kind.push_back(hit->kind);
    }
    return {};
  };
  const auto pass_on = [&](std::size_t chunk) -> Result<void> { return take(std::exchange(found[chunk], {})); };
  return parallel_ordered(reader.chunk_count(), workers, static_cast<std::size_t>(workers), look, pass_on);
}

Result<VoxelCloud> VoxelCloud::open(const tile::Store& store, const tile::ScanEntry& scan,
                                    const VoxelCloudOptions& options, Progress& progress) {
  RAYFIELD_ASSIGN(Estimation estimation, read_estimation(store, scan));
  auto impl =
      std::make_shared<Impl>(Impl{store, scan, options, std::move(estimation), VoxelDensities(options.scratch_folder)});
  RAYFIELD_CHECK(impl->estimate(progress));
  VoxelCloud cloud;
  cloud.impl_ = std::move(impl);
  return cloud;
}

double VoxelCloud::plant_area_m2() const { return impl_->densities.plant_area_m2; }
double VoxelCloud::canopy_area_m2() const { return impl_->densities.canopy_area_m2; }

Result<void> VoxelCloud::for_voxels(const std::function<void(std::span<const float>)>& take) const {
  constexpr std::uint64_t kAtATime = std::uint64_t{1} << 18;
  std::vector<float> values;
  for (std::uint64_t first = 0; first < impl_->densities.count(); first += values.size()) {
    values.resize(static_cast<std::size_t>(std::min(kAtATime, impl_->densities.count() - first)));
    RAYFIELD_CHECK(impl_->densities.read(first, values));
    take(values);
  }
  return {};
}

Result<void> VoxelCloud::for_hits(Progress& progress,
                                  const std::function<Result<void>(const DensityPoints& points)>& take) const {
  const tile::ScanEntry& scan = impl_->scan;
  progress.stage(fmt::format("{}: point cloud", scan.scan_id), scan.ray_count, "rays");
  for (const tile::TileEntry& entry : scan.tiles) {
    RAYFIELD_CHECK(check_cancelled(progress));
    RAYFIELD_ASSIGN(HitLocator::Scene scene, impl_->scene_of_tile({entry.index, impl_->store.config().tile_size_m}));
    if (!scene.segments.empty()) RAYFIELD_CHECK(impl_->pass_tile(entry, std::move(scene), progress, take));
    progress.advance(entry.start_count);
  }
  return {};
}

}  // namespace rayfield::density
