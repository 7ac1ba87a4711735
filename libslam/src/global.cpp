#include "global.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include "global_terms.h"

namespace rayfield::slam {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// What one iteration does (method: annealing, release).
struct Step {
  bool revisits = false, gps = false;
  bool coarse = false;     // knots of the coarse spline
  double anneal = 0;       // of the match radius of revisits, 0: first, 1: last
  double slack_m = 0;      // of the weights of revisits
  double gps_slack = 1;    // factor on the scale of the weights of fixes
  double max_gap_s = 1e9;  // revisits further apart in time are left out
};

std::vector<Step> schedule(const GlobalOptions& options, bool has_gps, double length_s) {
  std::vector<Step> steps;
  // Far from its start the drive may have drifted by more than fixes scatter.
  constexpr double kFirstGpsSlack = 16, kLeastSlack = 0.01;
  for (int k = 0; k < options.odometry_iterations; ++k) steps.push_back({false, has_gps, true, 0, 0, kFirstGpsSlack});
  // Lanes driven one after the other are tied first, when drift is least: by the time lanes far apart in time are
  // matched, the ties between have brought them closer than rows look alike.
  for (double gap = options.first_gap_s; gap < length_s; gap *= 2)
    steps.push_back({true, has_gps, true, 0, options.first_slack_m, 1, gap});
  const double last = std::max(1, options.revisit_iterations - 1);
  for (int k = 0; k < options.revisit_iterations; ++k) {
    const double anneal = k / last;
    const double slack = options.first_slack_m * std::pow(kLeastSlack / options.first_slack_m, anneal);
    steps.push_back({true, has_gps, 2 * k < options.revisit_iterations, anneal, slack, 1});
  }
  for (int k = 0; k < options.release_iterations; ++k) steps.push_back({true, false, false, 1, 0, 1});
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
  query.max_gap_s = step.max_gap_s;
  out.revisits = mutual_matches(placed, options.surfels.voxel_size_m, query, threads);
  return out;
}

// The robust spread of a flat surface seen at different visits.
void measure_thickness(const OdometryResult& odometry, const std::vector<SurfelMatch>& revisits, GlobalStats& stats) {
  std::vector<double> offsets;
  for (const SurfelMatch& m : revisits) {
    const Surfel &a = odometry.surfels[m.first], &b = odometry.surfels[m.second];
    if (a.variance_m2 > 4e-4f || b.variance_m2 > 4e-4f) continue;  // foliage: thick by nature
    offsets.push_back(std::abs(surfel_offset(odometry.track, a, b)));
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
  const double length = odometry.track.end_s();
  const double coarse_step = std::max(options.global.knot_step_s, length / options.global.coarse_knots);
  const double fine_step = std::max(options.global.knot_step_s, length / options.global.fine_knots);
  std::optional<GlobalProblem> problem;
  Eigen::Vector2d offsets = Eigen::Vector2d::Zero();
  const auto use_knots = [&](double step_s) {
    if (problem && problem->knot_step_s() == step_s) return;
    if (problem) offsets = problem->offsets();
    problem.emplace(odometry, imu, fixes, rig, options, step_s, offsets);
  };
  GlobalStats stats;
  const std::vector<Step> steps = schedule(options.global, !fixes.empty(), length);
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
    use_knots(step.coarse ? coarse_step : fine_step);
    RAYFIELD_CHECK(
        problem->linearise(matches.near, matches.revisits, step.slack_m, step.gps ? step.gps_slack : 0.0, stats));
    RAYFIELD_ASSIGN(stats.last_correction_m, problem->solve_and_apply());
    stats.solving_seconds += now_s() - begin;
    ++stats.iterations;
    progress.advance(1);
    if (!step.gps && step.revisits && stats.last_correction_m < options.global.converged_m) break;
  }
  matches = find_matches(odometry, steps.back(), options);
  use_knots(coarse_step);  // covariances need a factor of the whole system
  RAYFIELD_CHECK(problem->linearise(matches.near, matches.revisits, 0.0, 0.0, stats));
  RAYFIELD_CHECK(problem->measure_uncertainty(stats));
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
