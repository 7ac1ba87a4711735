#include "libdensity/scan/scan_leaf_angles.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/scan_voxels.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"
#include "libdensity/tiles/stored.h"
#include "libdensity/voxels/voxel_grid.h"

namespace rayfield::density {
namespace {

constexpr const char* kKind = "leaf_angles";
constexpr const char* kColumn = "fit";
constexpr std::size_t kMostSegments = 16;
constexpr std::size_t kMostVoxels = 400000;
constexpr double kCoarser = 1.5, kCoarsestM = 0.3;

/// Evenly from all.
RowSegmentList some_of(RowSegmentList list) {
  const std::size_t count = list.row_segments.size();
  if (count <= kMostSegments) return list;
  std::vector<RowSegment> kept;
  for (std::size_t k = 0; k < kMostSegments; ++k) kept.push_back(list.row_segments[k * count / kMostSegments]);
  list.row_segments = std::move(kept);
  return list;
}

/// In voxels of `sample_m`, or for crowns of trees in larger ones.
Result<RowSegmentList> sampled_segments(const RowLayout& layout, const GroundModel& ground,
                                        const CanopyProfile& profile, const ProcessOptions& options) {
  for (double voxel_m = options.voxel_fit.sample_m;; voxel_m *= kCoarser) {
    RAYFIELD_ASSIGN(
        RowSegmentList all,
        make_row_segments(layout, ground, profile, with_voxel_size(options.segments, std::min(voxel_m, kCoarsestM))));
    RowSegmentList some = some_of(std::move(all));
    std::size_t voxels = 0;
    for (const RowSegment& s : some.row_segments) voxels += s.shape().columns() * static_cast<std::size_t>(s.n_up);
    if (voxels <= kMostVoxels || voxel_m >= kCoarsestM) return some;
  }
}

/// By row and number of the row segment.
using Likelihoods = std::map<std::pair<int, int>, DirectionLikelihood>;

/// How many row segments from the one at `first` on have room for their directions, at least one.
std::size_t segments_with_room(const ScanWork& work, const VoxelAccumulator& empty, std::size_t first) {
  const std::vector<std::size_t> voxels = empty.voxel_counts();
  std::size_t bytes = empty.bytes(), count = 0;
  for (; first + count < voxels.size(); ++count) {
    bytes += voxels[first + count] * sizeof(DirectionCounters);
    if (count > 0 && 2 * bytes > work.memory.counts_bytes) break;  // as counting_workers() reckons
  }
  return count;
}

// One tile. Read more than once where memory is short, with the same result.
Result<void> add_tile(ScanWork& work, const tile::TileEntry& entry, const VoxelAccumulator& empty, double full_echo,
                      Likelihoods& sums) {
  RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
  const std::size_t segments = empty.voxel_counts().size();
  for (std::size_t first = 0; first < segments;) {
    const std::size_t count = segments_with_room(work, empty, first);
    VoxelAccumulator with_directions = empty;
    with_directions.keep_directions(first, count);
    RAYFIELD_ASSIGN(const int workers, counting_workers(work, entry.index, with_directions));
    RAYFIELD_ASSIGN(VoxelAccumulator sum, accumulate_tile(reader, std::move(with_directions), workers, work.progress));
    const TileVoxels voxels = std::move(sum).finish();
    for (const RowSegmentVoxels& segment : voxels.row_segments) {
      DirectionLikelihood& of_segment = sums[{segment.row_segment.row, segment.row_segment.index}];
      for (const DirectionCounters& voxel : segment.directions) of_segment.add(voxel, full_echo);
    }
    first += count;
  }
  return {};
}

Result<LeafAngleFit> fit_scan(ScanWork& work, const RowSegmentList& row_segments, std::span<const WoodCylinder> wood,
                              const std::shared_ptr<const BeamView>& view) {
  Likelihoods sums;
  work.progress.stage(fmt::format("{}: leaf angles", work.scan.scan_id), work.scan.tiles.size(), "tiles");
  for (const tile::TileEntry& entry : work.scan.tiles) {
    work.progress.advance(1);
    const TileScene scene = scene_of(work.tile_of(entry), work.store.config().tile_margin_m, row_segments, wood);
    if (scene.row_segments.empty()) continue;
    RAYFIELD_ASSIGN(VoxelAccumulator empty,
                    VoxelAccumulator::create(work.tile_of(entry), scene.row_segments, scene.wood, work.voxels, view));
    if (empty.empty()) continue;
    RAYFIELD_CHECK(add_tile(work, entry, empty, view ? view->full_echo : 1, sums));
  }
  std::vector<DirectionLikelihood> parts;
  for (const auto& [segment, likelihood] : sums) parts.push_back(likelihood);
  return fit_leaf_angles(parts, view != nullptr);
}

std::string key_of(const ScanWork& work, const std::shared_ptr<const BeamView>& view) {
  KeyBuilder key(kKind, kLeafAnglesVersion);
  key.add(option_numbers(work.options.segments)).add(option_numbers(work.voxels)).add(work.options.voxel_fit.sample_m);
  if (view) {
    add_beam(key, view->beam);
    key.add(view->full_echo).add(view->behind_m);
  }
  key.add(work.layout_key).add(work.files.sha256("profile", "block"));
  for (const tile::TileEntry& entry : work.scan.tiles)
    key.add(entry.content_sha256()).add(work.files.sha256("ground", tile_name(entry.index)));
  return key.hex();
}

Result<LeafAngleFit> fit_from(const tile::ArraySet& arrays) {
  RAYFIELD_ASSIGN(const auto f, stored_column<double>(arrays, kColumn, 3));
  if (!std::isfinite(f[0]) || std::abs(f[0]) > 3 || !(f[1] >= 0)) return damaged(arrays, "the fit cannot be");
  return LeafAngleFit{f[0], f[1], f[2] != 0};
}

}  // namespace

Result<LeafAngleFit> measure_leaf_angles(ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                                         const CanopyProfile& profile, std::span<const WoodCylinder> wood,
                                         const std::shared_ptr<const BeamView>& view,
                                         const std::optional<EchoModel>& echoes) {
  if (work.options.voxels.leaf_angles.type != LeafAngleType::measured ||
      work.options.estimator.estimator == Estimator::paper || (!echoes && !has_thin_beam(work.scan)))
    return LeafAngleFit{};
  std::shared_ptr<const BeamView> with_echo;
  if (view && echoes) {
    auto copy = std::make_shared<BeamView>(*view);
    copy->full_echo = echoes->full_echo;
    with_echo = copy;
  }
  const auto make = [&]() -> Result<tile::ArraySet> {
    RAYFIELD_ASSIGN(const RowSegmentList row_segments, sampled_segments(layout, ground, profile, work.options));
    RAYFIELD_ASSIGN(const LeafAngleFit fit, fit_scan(work, row_segments, wood, with_echo));
    tile::ArraySet arrays{.kind = kKind, .attributes = "{}"};
    arrays.columns[kColumn] = std::vector<double>{fit.ln_ratio, fit.error, fit.measured ? 1.0 : 0.0};
    return arrays;
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get(kKind, "block", key_of(work, with_echo), make));
  return fit_from(arrays);
}

Result<LeafAngleFit> read_leaf_angles(const tile::Store& store, const tile::ScanEntry& scan) {
  for (const tile::DerivedEntry& entry : scan.derived) {
    if (entry.kind != kKind) continue;
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(entry));
    return fit_from(arrays);
  }
  return LeafAngleFit{};
}

std::string leaf_angle_note(const tile::ScanEntry& scan, const LeafAngleFit& fit) {
  const LeafAngles angles = fit.angles();
  if (angles.type == LeafAngleType::spherical) return {};
  return fmt::format(
      "the leaves of {} lie flatter than leaves turned at random: steep rays meet more of them than level ones, as "
      "the faces of ellipsoids {:.1f} times as wide as high (± {:.0f} %), and areas are counted for such",
      scan.scan_id, angles.ellipsoid_ratio, 100 * fit.error);
}

}  // namespace rayfield::density
