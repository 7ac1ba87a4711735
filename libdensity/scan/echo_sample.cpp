#include "libdensity/scan/echo_sample.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "libdensity/scan/scan_voxels.h"
#include "libdensity/tiles/accumulate.h"
#include "libdensity/voxels/voxel_accumulator.h"

namespace rayfield::density {
namespace {

constexpr double kMostEchoes = 800000;  // of a tile, from there on a share of its plan is looked at for full ones
// Of a scan, of which a tile gives what its hits are of all, and at least a sixteenth: with so many the errors of the
// full echo and of the range resolution are those of what they are taken for, and not of their numbers.
constexpr double kEnoughFull = 5000, kEnoughLookedAt = 90000, kLeastPart = 1.0 / 16;
constexpr std::uint64_t kEnoughEchoes = 200000;
constexpr std::int64_t kEnoughMixed = 6000;

/// Spread over the block.
std::vector<tile::TileEntry> tiles_with_rows(const ScanWork& work, const RowSegmentList& row_segments) {
  std::vector<const tile::TileEntry*> with_rows;
  for (const tile::TileEntry& entry : work.scan.tiles)
    if (!scene_of(work.tile_of(entry), 0, row_segments, {}).row_segments.empty()) with_rows.push_back(&entry);
  std::vector<tile::TileEntry> out;
  for (const std::size_t i : spread_order(with_rows.size())) out.push_back(*with_rows[i]);
  return out;
}

// One tile, `part` of what is wanted. Sums of integers, so that the order of the rays does not matter.
Result<void> sample_tile(ScanWork& work, const tile::TileEntry& entry, double part, VoxelAccumulator empty,
                         SampledEchoes& sampled) {
  RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
  const auto add_pairs = [](VoxelAccumulator& sum, const tile::SegmentBatch& rays) { sum.add_pairs(rays); };
  empty.count_pairs_only();
  RAYFIELD_ASSIGN(const int workers, counting_workers(work, entry.index, empty));
  empty.keep_leaf_echoes(kMostEchoes / static_cast<double>(std::max<std::uint64_t>(1, entry.hit_count)));
  RAYFIELD_ASSIGN(VoxelAccumulator sum, accumulate_tile(reader, std::move(empty), workers, work.progress, add_pairs));
  if (sum.echo_statistics()) {
    if (!sampled.statistics) sampled.statistics.emplace();
    sampled.statistics->merge(*sum.echo_statistics());
    const EchoColumns leaf_echoes(sum.take_leaf_echoes());
    const auto part_of = [part](double all) { return static_cast<std::size_t>(std::ceil(part * all)); };
    sampled.statistics->add_full_echoes(find_full_echoes(leaf_echoes, part_of(kEnoughFull)));
    sampled.statistics->add_mixed_echoes(find_mixed_echoes(leaf_echoes, part_of(kEnoughLookedAt)));
  }
  sampled.pairs += std::move(sum).finish().pairs;
  return {};
}

}  // namespace

// By their bits read backwards.
std::vector<std::size_t> spread_order(std::size_t count) {
  const auto backwards = [](std::size_t number) {
    std::size_t out = 0;
    for (int bit = 0; bit < 64; ++bit) out |= (number >> bit & 1U) << (63 - bit);
    return out;
  };
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return backwards(a) < backwards(b); });
  return order;
}

bool tells_enough(const SampledEchoes& sampled) {
  return sampled.statistics && sampled.statistics->echoes() >= kEnoughEchoes &&
         static_cast<double>(sampled.statistics->full().size()) >= kEnoughFull &&
         sampled.statistics->mixed().count() >= kEnoughMixed;
}

Result<SampledEchoes> sample_echoes(ScanWork& work, const RowSegmentList& row_segments,
                                    std::span<const WoodCylinder> wood, const std::shared_ptr<const BeamView>& view) {
  SampledEchoes sampled;
  const std::vector<tile::TileEntry> tiles = tiles_with_rows(work, row_segments);
  double hits = 1;
  for (const tile::TileEntry& entry : tiles) hits += static_cast<double>(entry.hit_count);
  work.progress.stage(fmt::format("{}: leaf size", work.scan.scan_id), tiles.size(), "tiles");
  RAYFIELD_CHECK(for_voxel_tiles(
      work, tiles, row_segments, wood, view, [&](const tile::TileEntry& entry, VoxelAccumulator empty) -> Result<void> {
        if (tells_enough(sampled)) return {};
        const double part = static_cast<double>(entry.hit_count) / hits;
        return sample_tile(work, entry, std::max(kLeastPart, part), std::move(empty), sampled);
      }));
  return sampled;
}

}  // namespace rayfield::density
