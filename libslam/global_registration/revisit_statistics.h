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

namespace rayfield::slam {

/// Where the map contradicts itself most: the 90th percentile of the offsets of revisits in every 20 s section of the
/// drive. In a correct map all sections are about alike. A lane that was taken for its neighbour lies on ground of
/// another shape, and a lane that is out of place meets its neighbours only here and there.
struct RevisitMisfit {
  double worst_m = 0, worst_s = 0;  ///< the largest 90th percentile, and the middle of its section
  double typical_m = 0;             ///< the median over the sections; 0 if there are fewer than three
};

/// A histogram with logarithmic bins: steps of 4 % from 1 µm to 2.5 m.
class LogHistogram {
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

/// Offsets between the surfels of all revisits (loop closures) of a drive.
class RevisitStatistics {
 public:
  explicit RevisitStatistics(double duration_s);

  void add(const PoseTrack& track, std::span<const Surfel> surfels, std::span<const SurfelMatch> revisits);

  std::uint64_t count() const { return all_.count(); }
  /// Robust standard deviation of one flat surface seen in different passes (1.4826 × median offset), m; 0 for none.
  double thickness_m() const { return 1.4826 * all_.quantile(0.5); }
  /// Pairs of 5 s sections that at least ten revisits link.
  std::uint64_t linked_sections() const;
  RevisitMisfit misfit() const;

 private:
  LogHistogram all_;
  std::vector<LogHistogram> sections_;
  std::map<std::pair<int, int>, std::uint32_t> links_;
};

}  // namespace rayfield::slam
