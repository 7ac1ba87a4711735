#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "libslam/surfels/surfel.h"
#include "libslam/trajectory/pose_track.h"
#include "rayfield/core/result.h"

namespace rayfield::slam {

/// A surfel at the place that the present trajectory gives it.
struct PlacedSurfel {
  Eigen::Vector3f center, normal;  ///< world, m
  float time_s;
  std::uint8_t level;
  float variance_m2;  ///< of the surface's thickness
};

/// Two surfels of one surface: indices into the placed surfels, first < second.
struct SurfelMatch {
  std::uint32_t first = 0, second = 0;
};

/// Which pairs are looked for.
struct MatchQuery {
  double radius_voxels = 1;  ///< in position–normal space, × voxel edge
  double max_radius_m = 1e9;
  double normal_scale_m = 0.5;
  double max_thickness_m = 1e9;  ///< of either surfel, standard deviation: pairs that are thicker are left out
  double min_gap_s = 0.7, max_gap_s = 1e9;  ///< |time difference| in [min, max)
};

/// Places surfels with the trajectory. `origin` is subtracted, so that single precision is enough (0.1 mm at 1 km).
std::vector<PlacedSurfel> place_surfels(std::span<const Surfel> surfels, const PoseTrack& track,
                                        const Eigen::Vector3d& origin, int threads);

/// Mutual nearest neighbours in position–normal space, d² = |Δx|² + (normal_scale·|Δn|)², within each level and with
/// the time difference asked for. Ties go to the lower index; the result is sorted and does not depend on `threads`.
/// With `own` (one per surfel) only matches whose first surfel is own are given.
std::vector<SurfelMatch> mutual_matches(std::span<const PlacedSurfel> surfels, std::span<const double> voxel_size_m,
                                        const MatchQuery& query, int threads, std::span<const std::uint8_t> own = {});

}  // namespace rayfield::slam
