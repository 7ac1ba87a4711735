#include "libdensity/leaf/leaf_pairs.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rayfield::density {
namespace {

constexpr auto kParts = {&PairCounts::near, &PairCounts::front, &PairCounts::same, &PairCounts::behind};

double total(const PairCounts& counts) {
  return static_cast<double>(std::accumulate(counts.near.begin(), counts.near.end(), std::uint64_t{0}));
}

}  // namespace

void LeafPairs::add(const TileVoxels& plant, const TileVoxels& wood) {
  plant_ += plant.pairs, wood_ += wood.pairs;
  for (const RowSegmentVoxels& w : wood.row_segments)
    for (const RowSegmentVoxels& p : plant.row_segments) {
      if (p.row_segment.row != w.row_segment.row || p.row_segment.index != w.row_segment.index) continue;
      for (std::size_t i = 0; i < std::min(p.voxels.size(), w.voxels.size()); ++i) {
        const double hits = w.voxels[i].hits, potential = w.voxels[i].potential_sides();
        if (!(hits > 0) || !(potential > 0)) continue;
        wood_hits_ += hits;
        expected_hits_ += hits * p.voxels[i].potential_sides() / potential;
      }
    }
}

PairCounts LeafPairs::counts(double window_m) const {
  const PairCounts plant = counts_of(plant_, window_m), wood = counts_of(wood_, window_m);
  PairCounts out;
  const double share = wood_share();
  for (const auto part : kParts)
    for (std::size_t i = 0; i < LeafSizePairs::kBins; ++i) {
      const double left = static_cast<double>((plant.*part)[i]) - share * static_cast<double>((wood.*part)[i]);
      (out.*part)[i] = static_cast<std::uint64_t>(std::llround(std::max(0.0, left)));
    }
  return out;
}

std::optional<double> LeafPairs::leaf_size_m2() const {
  const PairWindows windows = windows_of(plant_);
  const PairCounts of_leaves = counts(windows.window_m);
  if (total(of_leaves) < kLeastShare * total(counts_of(plant_, windows.window_m))) return std::nullopt;
  const LeafSize size = estimate_leaf_size(of_leaves, windows);
  return size.measured ? std::optional(size.area_m2) : std::nullopt;
}

}  // namespace rayfield::density
