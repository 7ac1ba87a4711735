#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "libslam/surfels/surfel.h"
#include "libslam/surfels/surfel_match.h"
#include "libslam/trajectory/pose_track.h"

/// What surfaces that were seen at different visits say of a map.
namespace rayfield::slam {

/// Where the map contradicts itself most. Every 20 s stretch has the 90th percentile of the offsets of its revisits; in
/// a map that is right all stretches are about alike. A lane that was taken for its neighbour lies on ground of another
/// shape, and a lane that was not brought home meets its neighbours only here and there.
struct VisitMisfit {
  double worst_m = 0, worst_s = 0;  ///< the largest 90th percentile, and the middle of its stretch
  double typical_m = 0;             ///< the median over the stretches; 0 where there are fewer than three
};

/// How many offsets there are of every size, in steps of 4 %, 1 µm – 2.5 m.
class OffsetHistogram {
 public:
  void add(double offset_m);
  std::uint64_t count() const { return count_; }
  /// 0 if there are none.
  double quantile(double share) const;

 private:
  static constexpr std::size_t kBins = 376;
  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
};

/// Collects the revisits of a drive.
class VisitSurvey {
 public:
  explicit VisitSurvey(double duration_s);

  void add(const PoseTrack& track, std::span<const Surfel> surfels, std::span<const SurfelMatch> revisits);

  std::uint64_t count() const { return all_.count(); }
  /// The robust spread of a flat surface seen at different visits (1.4826 × median of the offsets), m; 0 for none.
  double thickness_m() const { return 1.4826 * all_.quantile(0.5); }
  /// Pairs of 5 s stretches that at least ten revisits link.
  std::uint64_t linked_visits() const;
  VisitMisfit misfit() const;

 private:
  OffsetHistogram all_;
  std::vector<OffsetHistogram> stretches_;
  std::map<std::pair<int, int>, std::uint32_t> links_;
};

}  // namespace rayfield::slam
