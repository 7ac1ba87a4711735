#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pose_track.h"
#include "surfel.h"
#include "surfel_match.h"

/// What surfaces that were seen at different visits say of a map.
namespace rayfield::slam {

/// The robust spread of a flat surface seen at different visits (1.4826 × median of the offsets), m; 0 for none.
double revisit_thickness(const PoseTrack& track, std::span<const Surfel> surfels,
                         std::span<const SurfelMatch> revisits);

/// Pairs of 5 s stretches that at least ten revisits link.
std::uint64_t count_linked_visits(std::span<const Surfel> surfels, std::span<const SurfelMatch> revisits);

/// Where the map contradicts itself most. Every 20 s stretch has the 90th percentile of the offsets of its revisits; in
/// a map that is right all stretches are about alike. A lane that was taken for its neighbour lies on ground of another
/// shape, and a lane that was not brought home meets its neighbours only here and there.
struct VisitMisfit {
  double worst_m = 0, worst_s = 0;  ///< the largest 90th percentile, and the middle of its stretch
  double typical_m = 0;             ///< the median over the stretches; 0 where there are fewer than three
};
VisitMisfit visit_misfit(const PoseTrack& track, std::span<const Surfel> surfels,
                         std::span<const SurfelMatch> revisits);

}  // namespace rayfield::slam
