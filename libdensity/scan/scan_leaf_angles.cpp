#include "libdensity/scan/scan_leaf_angles.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "libdensity/leaf_angles/leaf_angle_arrays.h"
#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/scan_voxels.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"
#include "libdensity/tiles/stored.h"
#include "libdensity/voxels/voxel_accumulator.h"

namespace rayfield::density {
namespace {

constexpr std::size_t kMostTiles = 8, kMostSegments = 16;
constexpr std::uint64_t kEnoughRays = 5000000;  // of more, only each n-th part of a tile is read
constexpr std::size_t kMostVoxels = 400000;
constexpr double kNoteworthyError = 0.05;  // of areas
constexpr double kCoarser = 1.5, kCoarsestM = 0.3;

/// Tiles in which leaf angles are measured, and the row segments.
struct Sample {
  std::vector<tile::TileEntry> tiles;
  std::size_t every = 1;  ///< n-th of their chunks
  RowSegmentList row_segments;
};

/// Those of the tiles with row segments in which every n-th hit of the scan lies.
std::vector<tile::TileEntry> some_tiles(const ScanWork& work, const RowSegmentList& row_segments) {
  std::vector<const tile::TileEntry*> with_rows;
  double hits = 0;
  for (const tile::TileEntry& entry : work.scan.tiles)
    if (!scene_of(work.tile_of(entry), 0, row_segments, {}).row_segments.empty())
      with_rows.push_back(&entry), hits += static_cast<double>(entry.hit_count);
  std::vector<tile::TileEntry> some;
  const double step = hits / static_cast<double>(kMostTiles);
  double passed = 0, next = step / 2;
  for (const tile::TileEntry* entry : with_rows) {
    passed += static_cast<double>(entry->hit_count);
    if (with_rows.size() > kMostTiles && passed < next) continue;
    some.push_back(*entry);
    while (next <= passed && step > 0) next += step;
  }
  return some;
}

/// Evenly from all in the tiles.
void keep_some_segments(const ScanWork& work, Sample& sample) {
  std::vector<RowSegment> in_tiles;
  for (const RowSegment& s : sample.row_segments.row_segments) {
    const RowSegmentList one{{s}, {}};
    if (std::any_of(sample.tiles.begin(), sample.tiles.end(), [&](const tile::TileEntry& entry) {
          return !scene_of(work.tile_of(entry), 0, one, {}).row_segments.empty();
        }))
      in_tiles.push_back(s);
  }
  sample.row_segments.row_segments.clear();
  const std::size_t count = std::min(kMostSegments, in_tiles.size());
  for (std::size_t k = 0; k < count; ++k)
    sample.row_segments.row_segments.push_back(in_tiles[k * in_tiles.size() / count]);
}

/// In voxels of `sample_m`, or for crowns of trees in larger ones.
Result<Sample> make_sample(const ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                           const CanopyProfile& profile) {
  for (double voxel_m = work.options.voxel_fit.sample_m;; voxel_m *= kCoarser) {
    Sample sample;
    RAYFIELD_ASSIGN(sample.row_segments,
                    make_row_segments(layout, ground, profile,
                                      with_voxel_size(work.options.segments, std::min(voxel_m, kCoarsestM))));
    sample.tiles = some_tiles(work, sample.row_segments);
    std::uint64_t rays = 0;
    for (const tile::TileEntry& entry : sample.tiles) rays += entry.segment_count;
    sample.every = std::max<std::size_t>(1, (rays + kEnoughRays - 1) / kEnoughRays);
    keep_some_segments(work, sample);
    std::size_t voxels = 0;
    for (const RowSegment& s : sample.row_segments.row_segments) voxels += s.shape().size();
    if (voxels <= kMostVoxels || voxel_m >= kCoarsestM) return sample;
  }
}

/// What the echoes of wide beams tell of how leaves are turned, and of how far directions can be trusted.
struct EchoHints {
  std::optional<LnRatio> normals;
  double lost_share = 0;
};

/// By row and number of the row segment.
using Likelihoods = std::map<std::pair<int, int>, DirectionLikelihood>;

/// How many row segments from the one at `first` on have room for their directions, at least one.
std::size_t segments_with_room(const ScanWork& work, const VoxelAccumulator& empty, std::size_t first) {
  const std::vector<std::size_t> voxels = empty.voxel_counts();
  std::size_t bytes = 0, count = 0;
  for (; first + count < voxels.size(); ++count) {
    bytes += voxels[first + count] * sizeof(DirectionCounters);
    if (count > 0 && 2 * bytes > work.memory.counts_bytes) break;  // as counting_workers() reckons
  }
  return count;
}

// One tile. Read more than once where memory is short, with the same result.
Result<void> add_tile(ScanWork& work, const tile::TileEntry& entry, const VoxelAccumulator& empty, std::size_t every,
                      const DirectionLikelihood& nothing, Likelihoods& sums) {
  RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
  const std::size_t segments = empty.voxel_counts().size();
  for (std::size_t first = 0; first < segments;) {
    const auto add = [](VoxelAccumulator& sum, const tile::SegmentBatch& rays) { return sum.add(rays); };
    const std::size_t count = segments_with_room(work, empty, first);
    VoxelAccumulator with_directions = empty;
    with_directions.count_directions_only(first, count);
    RAYFIELD_ASSIGN(const int workers, counting_workers(work, entry.index, with_directions));
    RAYFIELD_ASSIGN(VoxelAccumulator sum,
                    accumulate_tile(reader, std::move(with_directions), workers, work.progress, add, every));
    const TileVoxels voxels = std::move(sum).finish();
    for (const RowSegmentVoxels& segment : voxels.row_segments) {
      const std::pair name(segment.row_segment.row, segment.row_segment.index);
      DirectionLikelihood& of_segment = sums.try_emplace(name, nothing).first->second;
      for (const DirectionCounters& voxel : segment.directions) of_segment.add(voxel);
    }
    first += count;
  }
  return {};
}

Result<LeafAngleFit> fit_sample(ScanWork& work, const Sample& sample, std::span<const WoodCylinder> wood,
                                const std::shared_ptr<const BeamView>& view, const EchoHints& echoes) {
  Likelihoods sums;
  const DirectionLikelihood nothing(view ? std::optional(view->full_echo) : std::nullopt);
  work.progress.stage(fmt::format("{}: leaf angles", work.scan.scan_id), sample.tiles.size(), "tiles");
  RAYFIELD_CHECK(for_voxel_tiles(work, sample.tiles, sample.row_segments, wood, view,
                                 [&](const tile::TileEntry& entry, const VoxelAccumulator& empty) {
                                   return add_tile(work, entry, empty, sample.every, nothing, sums);
                                 }));
  std::vector<DirectionLikelihood> parts;
  for (const auto& [segment, likelihood] : sums) parts.push_back(likelihood);
  return fit_leaf_angles(parts, work.options.voxels.leaf_angles, echoes.normals, echoes.lost_share);
}

std::string key_of(const ScanWork& work, const std::shared_ptr<const BeamView>& view, const EchoHints& echoes) {
  KeyBuilder key(kLeafAnglesKind, kLeafAnglesVersion);
  key.add(option_numbers(work.options.segments)).add(option_numbers(work.voxels)).add(work.options.voxel_fit.sample_m);
  if (view) {
    add_beam(key, view->beam);
    key.add(view->full_echo).add(view->behind_m).add(view->followed_m);
  }
  if (echoes.normals) key.add(echoes.normals->value).add(echoes.normals->error);
  key.add(echoes.lost_share);
  key.add(work.layout_key).add(work.files.sha256("profile", "block"));
  for (const tile::TileEntry& entry : work.scan.tiles)
    key.add(entry.content_sha256()).add(work.files.sha256("ground", tile_name(entry.index)));
  return key.hex();
}

}  // namespace

Result<LeafAngleFit> measure_leaf_angles(ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                                         const CanopyProfile& profile, std::span<const WoodCylinder> wood,
                                         const std::shared_ptr<const BeamView>& view,
                                         const std::optional<EchoModel>& echoes) {
  const bool measures = work.options.voxels.leaf_angles.type == LeafAngleType::measured && has_thin_beam(work.scan);
  const bool shows_leaves = echoes && !echoes->wood_returned;
  if (work.options.estimator.estimator == Estimator::paper || (!shows_leaves && !measures)) return LeafAngleFit{};
  std::shared_ptr<const BeamView> with_echo;
  if (view && echoes) {
    auto copy = std::make_shared<BeamView>(*view);
    copy->full_echo = echoes->full_echo;
    with_echo = copy;
  }
  const EchoHints hints = shows_leaves ? EchoHints{echoes->leaf_normals, echoes->lost_share} : EchoHints{};
  const auto make = [&]() -> Result<tile::ArraySet> {
    RAYFIELD_ASSIGN(const Sample sample, make_sample(work, layout, ground, profile));
    RAYFIELD_ASSIGN(const LeafAngleFit fit, fit_sample(work, sample, wood, with_echo, hints));
    return arrays_from_leaf_angles(fit);
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays,
                  work.files.get(kLeafAnglesKind, "block", key_of(work, with_echo, hints), make));
  return leaf_angles_from_arrays(arrays);
}

Result<LeafAngleFit> read_leaf_angles(const tile::Store& store, const tile::ScanEntry& scan) {
  for (const tile::DerivedEntry& entry : scan.derived) {
    if (entry.kind != kLeafAnglesKind) continue;
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(entry));
    return leaf_angles_from_arrays(arrays);
  }
  return LeafAngleFit{};
}

std::string leaf_angle_note(const tile::ScanEntry& scan, const LeafAngleFit& fit) {
  const LeafAngles angles = fit.angles();
  const double error = fit.area_error();
  if (angles.type == LeafAngleType::spherical && !fit.tells())
    return fmt::format(
        "how the leaves of {} are turned is not told: too few beams fall wholly on a leaf; they are taken to be turned "
        "at random, and areas are larger, by up to about {:.0f} %, if they lie flat, which is in the intervals",
        scan.scan_id, 100 * std::expm1(2 * error));
  if (angles.type == LeafAngleType::spherical)
    return error < kNoteworthyError
               ? std::string()
               : fmt::format(
                     "the leaves of {} look a little flatter than leaves turned at random; they are taken for such, "
                     "and areas may be {:.0f} % larger, which is in the intervals",
                     scan.scan_id, 100 * std::expm1(error));
  return fmt::format(
      "the leaves of {} lie flatter than leaves turned at random: steep rays meet more of them than level ones, as "
      "the faces of ellipsoids {:.1f} times as wide as high (± {:.0f} %), and areas are counted for such, which leaves "
      "± {:.0f} %, in the intervals",
      scan.scan_id, angles.ellipsoid_ratio, 100 * fit.flatter()->error, 100 * error);
}

}  // namespace rayfield::density
