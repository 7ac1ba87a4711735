#include "global.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "global_terms.h"
#include "visits.h"

namespace rayfield::slam {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

constexpr int kNearInterval = 4;  // iterations between two searches for near matches

// What one iteration does (method: annealing, release).
struct Step {
  bool revisits = false, gps = false;
  bool coarse = false;     // knots of the coarse spline
  bool foliage = false;    // thick surfaces count among the revisits
  double anneal = 0;       // of the match radius of revisits, 0: first, 1: last
  double slack_m = 0;      // of the weights of revisits
  double gps_slack = 1;    // factor on the scale of the weights of fixes
  double max_gap_s = 1e9;  // revisits further apart in time are left out
};

// Lanes driven one after the other are tied first, where they meet, when drift is least: with every iteration revisits
// a little further apart in time, so that what is tied already brings the next stretch closer than rows look alike.
std::vector<double> growing_gaps(const GlobalOptions& options, double length_s) {
  std::vector<double> gaps = {options.first_gap_s};
  while (gaps.back() < length_s) gaps.push_back(gaps.back() * options.gap_growth);
  return gaps;
}

// The steps after all visits have been tied.
std::vector<Step> last_steps(const GlobalOptions& options, bool has_gps) {
  constexpr double kLeastSlack = 0.01;
  std::vector<Step> steps;
  const double last = std::max(1, options.revisit_iterations - 1);
  for (int k = 0; k < options.revisit_iterations; ++k) {
    const double anneal = k / last;
    const double slack = options.first_slack_m * std::pow(kLeastSlack / options.first_slack_m, anneal);
    steps.push_back({true, has_gps, 2 * k < options.revisit_iterations, false, anneal, slack, 1});
  }
  for (int k = 0; k < options.release_iterations; ++k) steps.push_back({true, false, false, false, 1, 0, 1});
  return steps;
}

struct Matches {
  std::vector<SurfelMatch> near, revisits;
};

// Fills the matches of a step. Near ones are kept where there are some: corrections hardly move surfels that are close
// in time against each other.
void find_matches(const OdometryResult& odometry, const Step& step, const SlamOptions& options, Matches& out) {
  const int threads = thread_count(options.threads);
  const auto placed =
      place_surfels(odometry.surfels, odometry.track, odometry.track.position[odometry.track.size() / 2], threads);
  MatchQuery query;
  query.normal_scale_m = options.match.normal_scale_m;
  query.radius_voxels = options.match.last_radius_voxels;
  query.min_gap_s = options.match.min_time_gap_s;
  query.max_gap_s = options.window.length_s;
  if (out.near.empty()) out.near = mutual_matches(placed, options.surfels.voxel_size_m, query, threads);
  if (!step.revisits) return;
  query.radius_voxels = options.match.first_radius_voxels *
                        std::pow(options.match.last_radius_voxels / options.match.first_radius_voxels, step.anneal);
  query.max_radius_m = 0.5 * options.global.row_spacing_m;
  query.min_gap_s = options.global.revisit_gap_s;
  query.max_gap_s = step.max_gap_s;
  if (!step.foliage) query.max_thickness_m = options.global.max_revisit_thickness_m;
  out.revisits = mutual_matches(placed, options.surfels.voxel_size_m, query, threads);
}

// Stage b at work.
class Registration {
 public:
  Registration(OdometryResult& odometry, const ImuGrid& imu, std::span<const GpsPosition> fixes, const Rig& rig,
               const SlamOptions& options, Progress& progress)
      : odometry_(odometry), imu_(imu), fixes_(fixes), rig_(rig), options_(options), progress_(progress) {}

  Result<GlobalStats> run() {
    const GlobalOptions& global = options_.global;
    const bool has_gps = !fixes_.empty();
    const std::vector<Step> last = last_steps(global, has_gps);
    const std::vector<double> gaps = growing_gaps(global, length_s());
    progress_.stage("global registration",
                    static_cast<std::uint64_t>(global.odometry_iterations) + gaps.size() + last.size(), "iterations");
    // Far from its start the drive may have drifted by more than fixes scatter.
    constexpr double kFirstGpsSlack = 16;
    for (int k = 0; k < global.odometry_iterations; ++k)
      RAYFIELD_CHECK(iterate({false, has_gps, true, false, 0, 0, kFirstGpsSlack}));
    for (const double gap : gaps) RAYFIELD_CHECK(iterate({true, has_gps, true, true, 0, global.first_slack_m, 1, gap}));
    std::vector<Eigen::Vector3d> before_release;
    for (const Step& step : last) {
      if (has_gps && !step.gps && before_release.empty()) before_release = odometry_.track.position;
      RAYFIELD_CHECK(iterate(step));
      if (!step.gps && stats_.last_correction_m < global.converged_m) break;
    }
    RAYFIELD_CHECK(measure(last.back(), before_release));
    return std::move(stats_);
  }

 private:
  double length_s() const { return odometry_.track.end_s(); }

  Result<void> iterate(const Step& step) {
    if (progress_.cancelled()) return fail(ErrorCode::interrupted, "stopped", "global registration", "by the user");
    double begin = now_s();
    if (stats_.iterations % kNearInterval == 0) matches_.near.clear();
    find_matches(odometry_, step, options_, matches_);
    stats_.matching_seconds += now_s() - begin;
    begin = now_s();
    use_knots(step.coarse);
    RAYFIELD_CHECK(
        problem_->linearise(matches_.near, matches_.revisits, {step.slack_m, step.gps ? step.gps_slack : 0.0}, stats_));
    RAYFIELD_ASSIGN(stats_.last_correction_m, problem_->solve_and_apply());
    stats_.solving_seconds += now_s() - begin;
    ++stats_.iterations;
    progress_.advance(1);
    return {};
  }

  void use_knots(bool coarse) {
    const int most = coarse ? options_.global.coarse_knots : options_.global.fine_knots;
    const double step_s = std::max(options_.global.knot_step_s, length_s() / most);
    if (problem_ && problem_->knot_step_s() == step_s) return;
    const Eigen::Vector2d offsets = problem_ ? problem_->offsets() : Eigen::Vector2d::Zero();
    problem_.emplace(odometry_, imu_, fixes_, rig_, options_, step_s, offsets);
  }

  Result<void> measure(const Step& last, const std::vector<Eigen::Vector3d>& before_release) {
    matches_ = {};
    find_matches(odometry_, last, options_, matches_);
    problem_->measure_imu_misfit(stats_);
    use_knots(true);  // covariances need a factor of the whole system
    RAYFIELD_CHECK(problem_->linearise(matches_.near, matches_.revisits, {0.0, 0.0, kIndependentShare}, stats_));
    RAYFIELD_CHECK(problem_->measure_uncertainty(stats_));
    stats_.thickness_count = matches_.revisits.size();
    stats_.thickness_m = revisit_thickness(odometry_.track, odometry_.surfels, matches_.revisits);
    stats_.linked_visits = count_linked_visits(odometry_.surfels, matches_.revisits);
    stats_.visits = visit_misfit(odometry_.track, odometry_.surfels, matches_.revisits);
    for (std::size_t k = 0; k < before_release.size(); ++k) {
      const double shift = (odometry_.track.position[k] - before_release[k]).norm();
      stats_.release_shift_mean_m += shift / static_cast<double>(before_release.size());
      stats_.release_shift_max_m = std::max(stats_.release_shift_max_m, shift);
    }
    return {};
  }

  OdometryResult& odometry_;
  const ImuGrid& imu_;
  std::span<const GpsPosition> fixes_;
  const Rig& rig_;
  const SlamOptions& options_;
  Progress& progress_;
  std::optional<GlobalProblem> problem_;
  Matches matches_;
  GlobalStats stats_;
};

}  // namespace

Result<GlobalStats> register_globally(OdometryResult& odometry, const ImuGrid& imu, std::span<const GpsPosition> fixes,
                                      const Rig& rig, const SlamOptions& options, Progress& progress) {
  return Registration(odometry, imu, fixes, rig, options, progress).run();
}

}  // namespace rayfield::slam
