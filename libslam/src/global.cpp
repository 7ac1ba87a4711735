#include "global.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "global_terms.h"

namespace rayfield::slam {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Where the schedule stands: what is matched, how far apart, and whether GPS acts (method: annealing, release).
struct Step {
  bool revisits = false, gps = false;
  double anneal = 0;  // 0: first, 1: last
};

std::vector<Step> schedule(const GlobalOptions& options, bool has_gps) {
  std::vector<Step> steps;
  for (int k = 0; k < options.odometry_iterations; ++k) steps.push_back({false, has_gps, 0});
  const double last = std::max(1, options.revisit_iterations - 1);
  for (int k = 0; k < options.revisit_iterations; ++k) steps.push_back({true, has_gps, k / last});
  for (int k = 0; k < options.release_iterations; ++k) steps.push_back({true, false, 1});
  return steps;
}

struct Matches {
  std::vector<SurfelMatch> near, revisits;
};

Matches find_matches(const OdometryResult& odometry, const Step& step, const SlamOptions& options) {
  const int threads = thread_count(options.threads);
  const auto placed =
      place_surfels(odometry.surfels, odometry.track, odometry.track.position[odometry.track.size() / 2], threads);
  Matches out;
  MatchQuery query;
  query.normal_scale_m = options.match.normal_scale_m;
  query.radius_voxels = options.match.last_radius_voxels;
  query.min_gap_s = options.match.min_time_gap_s;
  query.max_gap_s = options.window.length_s;
  out.near = mutual_matches(placed, options.surfels.voxel_size_m, query, threads);
  if (!step.revisits) return out;
  query.radius_voxels = options.match.first_radius_voxels *
                        std::pow(options.match.last_radius_voxels / options.match.first_radius_voxels, step.anneal);
  query.max_radius_m = 0.5 * options.global.row_spacing_m;
  query.min_gap_s = options.global.revisit_gap_s;
  query.max_gap_s = 1e9;
  out.revisits = mutual_matches(placed, options.surfels.voxel_size_m, query, threads);
  return out;
}

// The robust spread of a flat surface seen at different visits.
void measure_thickness(const OdometryResult& odometry, const std::vector<SurfelMatch>& revisits, GlobalStats& stats) {
  ResidualFrame frame;
  frame.track = &odometry.track;
  std::vector<double> offsets;
  for (const SurfelMatch& m : revisits) {
    const Surfel &a = odometry.surfels[m.first], &b = odometry.surfels[m.second];
    if (a.variance_m2 > 4e-4f || b.variance_m2 > 4e-4f) continue;  // foliage: thick by nature
    offsets.push_back(std::abs(surfel_residual(frame, a, b).error[0]));
  }
  stats.thickness_count = offsets.size();
  stats.thickness_m = 1.4826 * median_of(std::move(offsets));
}

std::uint64_t count_linked_visits(const OdometryResult& odometry, const std::vector<SurfelMatch>& revisits) {
  constexpr double kStretchSeconds = 5.0;
  std::map<std::pair<int, int>, int> links;
  for (const SurfelMatch& m : revisits) {
    const int a = static_cast<int>(odometry.surfels[m.first].time_s / kStretchSeconds);
    const int b = static_cast<int>(odometry.surfels[m.second].time_s / kStretchSeconds);
    ++links[{std::min(a, b), std::max(a, b)}];
  }
  std::uint64_t linked = 0;
  for (const auto& [pair, count] : links) linked += count >= 10;
  return linked;
}

}  // namespace

Result<GlobalStats> register_globally(OdometryResult& odometry, const ImuGrid& imu, std::span<const GpsPosition> fixes,
                                      const Rig& rig, const SlamOptions& options, Progress& progress) {
  GlobalProblem problem(odometry, imu, fixes, rig, options);
  GlobalStats stats;
  const std::vector<Step> steps = schedule(options.global, !fixes.empty());
  progress.stage("global registration", steps.size(), "iterations");
  std::vector<Eigen::Vector3d> before_release;
  Matches matches;
  for (const Step& step : steps) {
    if (progress.cancelled()) return fail(ErrorCode::interrupted, "stopped", "global registration", "by the user");
    double begin = now_s();
    matches = find_matches(odometry, step, options);
    stats.matching_seconds += now_s() - begin;
    begin = now_s();
    if (!fixes.empty() && !step.gps && before_release.empty()) before_release = odometry.track.position;
    const double cauchy =
        options.match.first_cauchy * std::pow(options.match.last_cauchy / options.match.first_cauchy, step.anneal);
    RAYFIELD_CHECK(problem.linearise(matches.near, matches.revisits, cauchy, step.gps, stats));
    RAYFIELD_CHECK(problem.solve_and_apply());
    stats.solving_seconds += now_s() - begin;
    ++stats.iterations;
    progress.advance(1);
  }
  matches = find_matches(odometry, steps.back(), options);
  RAYFIELD_CHECK(problem.linearise(matches.near, matches.revisits, options.match.last_cauchy, false, stats));
  RAYFIELD_CHECK(problem.measure_uncertainty(stats));
  measure_thickness(odometry, matches.revisits, stats);
  stats.linked_visits = count_linked_visits(odometry, matches.revisits);
  for (std::size_t k = 0; k < before_release.size(); ++k) {
    const double shift = (odometry.track.position[k] - before_release[k]).norm();
    stats.release_shift_mean_m += shift / static_cast<double>(before_release.size());
    stats.release_shift_max_m = std::max(stats.release_shift_max_m, shift);
  }
  return stats;
}

}  // namespace rayfield::slam
