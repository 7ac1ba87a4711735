#pragma once

#include <functional>
#include <span>
#include <vector>

#include "libslam/odometry/odometry.h"
#include "libslam/surfels/surfel_match.h"
#include "libslam/surfels/surfel_regions.h"
#include "rayfield/core/result.h"
#include "rayfield/slam/options.h"

namespace rayfield::slam {

/// Which surfels an iteration of the global registration matches.
struct MatchStep {
  bool revisits = false;   ///< also those that are far apart in time
  bool foliage = false;    ///< thick surfaces count among the revisits
  double anneal = 0;       ///< of the match radius of revisits, 0: first, 1: last
  double max_gap_s = 1e9;  ///< revisits further apart in time are left out
};

/// The matches of one region: indices into its surfels.
struct RegionMatches {
  std::span<const Surfel> surfels;
  std::span<const SurfelMatch> near, revisits;
};

/// Matches all surfels of a drive, region by region, with no more than a region in memory.
class RegionMatching {
 public:
  explicit RegionMatching(const SlamOptions& options);

  /// Finds the matches of a step at the present trajectory and calls consume() for every region, in a fixed order. Near
  /// matches are kept for some calls, since corrections hardly move surfels that are close in time against each other;
  /// with `fresh` they are searched for again.
  Result<void> match_regions(const OdometryResult& odometry, const SurfelOffsets& offsets, const MatchStep& step,
                             bool fresh, const std::function<Result<void>(const RegionMatches&)>& consume);

 private:
  MatchQuery near_query() const;
  MatchQuery revisit_query(const MatchStep& step) const;
  Result<void> find_near(std::size_t region, std::span<const PlacedSurfel> placed, std::vector<SurfelMatch>& out);

  const SlamOptions& options_;
  SurfelRegions regions_;
  SurfelRegion region_;
  SpillFile near_file_;
  std::vector<SpillFile::Extent> near_;  // by region; those not yet found are missing
  int calls_ = 0;
};

}  // namespace rayfield::slam
