#include "libslam/global_registration/region_matching.h"

#include <algorithm>
#include <cmath>

#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr int kNearInterval = 4;  // calls between two searches for near matches

// How far the two surfels of a match may be apart, for each level.
std::vector<double> reach_of(const SlamOptions& options) {
  const double near = options.match.last_radius_voxels;
  const double revisits = std::max(options.match.first_radius_voxels, options.match.last_radius_voxels);
  std::vector<double> reach;
  for (const double voxel : options.surfels.voxel_size_m)
    reach.push_back(std::max(near * voxel, std::min(revisits * voxel, 0.5 * options.global.row_spacing_m)));
  return reach;
}

}  // namespace

RegionMatching::RegionMatching(const SlamOptions& options)
    : options_(options),
      regions_(options.scratch_directory(), {.reach_m = reach_of(options)}),
      near_file_(options.scratch_directory()) {}

MatchQuery RegionMatching::near_query() const {
  MatchQuery query;
  query.normal_scale_m = options_.match.normal_scale_m;
  query.radius_voxels = options_.match.last_radius_voxels;
  query.min_gap_s = options_.match.min_time_gap_s;
  query.max_gap_s = options_.window.length_s;
  return query;
}

MatchQuery RegionMatching::revisit_query(const MatchStep& step) const {
  MatchQuery query;
  query.normal_scale_m = options_.match.normal_scale_m;
  query.radius_voxels = options_.match.first_radius_voxels *
                        std::pow(options_.match.last_radius_voxels / options_.match.first_radius_voxels, step.anneal);
  query.max_radius_m = 0.5 * options_.global.row_spacing_m;
  query.min_gap_s = options_.global.revisit_gap_s;
  query.max_gap_s = step.max_gap_s;
  if (!step.foliage) query.max_thickness_m = options_.global.max_revisit_thickness_m;
  return query;
}

Result<void> RegionMatching::find_near(std::size_t region, std::span<const PlacedSurfel> placed,
                                       std::vector<SurfelMatch>& out) {
  if (region < near_.size()) {
    out.resize(near_[region].size / sizeof(SurfelMatch));
    return near_file_.read(near_[region], std::as_writable_bytes(std::span(out)));
  }
  out =
      mutual_matches(placed, options_.surfels.voxel_size_m, near_query(), thread_count(options_.threads), region_.own);
  RAYFIELD_ASSIGN(const SpillFile::Extent extent, near_file_.append(std::as_bytes(std::span(out))));
  near_.push_back(extent);
  return {};
}

Result<void> RegionMatching::match_regions(const OdometryResult& odometry, const SurfelOffsets& offsets,
                                           const MatchStep& step, bool fresh,
                                           const std::function<Result<void>(const RegionMatches&)>& consume) {
  const int threads = thread_count(options_.threads);
  RAYFIELD_ASSIGN(const bool laid_out, regions_.update_layout(odometry.surfels, odometry.track, offsets, threads));
  if (laid_out || fresh || calls_ % kNearInterval == 0) {
    near_.clear();
    RAYFIELD_CHECK(near_file_.clear());
  }
  ++calls_;
  std::vector<SurfelMatch> near, revisits;
  for (std::size_t k = 0; k < regions_.count(); ++k) {
    RAYFIELD_CHECK(regions_.load(k, region_));
    std::vector<PlacedSurfel> placed;
    if (k >= near_.size() || step.revisits)
      placed = place_surfels(region_.surfels, odometry.track, region_.center, threads);
    RAYFIELD_CHECK(find_near(k, placed, near));
    if (step.revisits)
      revisits = mutual_matches(placed, options_.surfels.voxel_size_m, revisit_query(step), threads, region_.own);
    RAYFIELD_CHECK(consume({region_.surfels, near, revisits}));
  }
  return {};
}

}  // namespace rayfield::slam
