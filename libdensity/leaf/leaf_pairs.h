#pragma once

#include <optional>

#include "libdensity/echoes/leaf_size.h"
#include "libdensity/voxels/voxel_grid.h"

namespace rayfield::density {

/// Neighbouring beams of which the first hit a leaf: those of a leafy scan less the wood's, as a dormant scan counts
/// them. Leaves hide wood, so that the dormant scan's pairs count in part only: as the hits on wood that are expected
/// in the leafy scan to those of the dormant one. Hits in a voxel go with the potential path P that reaches it,
/// expected are Σ m_wood·P_plant/P_wood.
class LeafPairs {
 public:
  /// The same tile in both scans, counted in one grid; each once.
  void add(const TileVoxels& plant, const TileVoxels& wood);

  /// The part of the dormant scan's pairs that is subtracted.
  double wood_share() const { return wood_hits_ > 0 ? expected_hits_ / wood_hits_ : 0; }
  /// What is negative by chance becomes 0.
  PairCounts counts(double window_m) const;
  /// Area of a leaf, m². Nothing where leaves have too small a part in the pairs (less than kLeastShare) for what
  /// remains to be more than the two scans' noise, or too few at all.
  std::optional<double> leaf_size_m2() const;

  static constexpr double kLeastShare = 0.2;

 private:
  LeafSizePairs plant_, wood_;
  double wood_hits_ = 0, expected_hits_ = 0;
};

}  // namespace rayfield::density
