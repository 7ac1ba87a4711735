#include "libslam/global_registration/global_registration.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "libslam/global_registration/region_matching.h"
#include "libslam/global_registration/registration_problem.h"
#include "libslam/global_registration/revisit_statistics.h"

namespace rayfield::slam {
namespace {

// What one iteration does: matching and weights are annealed step by step, then GPS is released.
struct Step {
  MatchStep match;
  bool gps = false;
  bool coarse = false;   // knots of the coarse spline
  double slack_m = 0;    // of the weights of revisits
  double gps_slack = 1;  // factor on the scale of the weights of fixes
};

// Loop closures are added in the order of their time gap: lanes driven one after the other are tied first, where drift
// is least. What is tied already brings the following lanes closer than the distance at which rows are confused.
std::vector<double> growing_gaps(const GlobalRegistrationOptions& options, double length_s) {
  std::vector<double> gaps = {options.first_gap_s};
  while (gaps.back() < length_s) gaps.push_back(gaps.back() * options.gap_growth);
  return gaps;
}

// The steps after loop closures of all time gaps have been matched.
std::vector<Step> last_steps(const GlobalRegistrationOptions& options, bool has_gps) {
  constexpr double kSmallestSlack_m = 0.01;
  std::vector<Step> steps;
  const double last = std::max(1, options.revisit_iterations - 1);
  for (int k = 0; k < options.revisit_iterations; ++k) {
    const double anneal = k / last;
    const double slack = options.first_slack_m * std::pow(kSmallestSlack_m / options.first_slack_m, anneal);
    steps.push_back({{true, false, anneal}, has_gps, 2 * k < options.revisit_iterations, slack});
  }
  for (int k = 0; k < options.release_iterations; ++k) steps.push_back({{true, false, 1}, false, false, 0});
  return steps;
}

// The state of one run of stage b.
class Registration {
 public:
  Registration(OdometryResult& odometry, const ImuGrid& imu, std::span<const GpsPosition> fixes, const Rig& rig,
               const SlamOptions& options, Progress& progress)
      : odometry_(odometry),
        imu_(imu),
        fixes_(fixes),
        rig_(rig),
        options_(options),
        progress_(progress),
        matching_(options) {}

  // All iterations: without loop closures, with more and more of them, with GPS, and without it. Then what can be said
  // of the result is measured once.
  Result<RegistrationStats> run() {
    const GlobalRegistrationOptions& global = options_.global;
    const bool has_gps = !fixes_.empty();
    const std::vector<Step> last = last_steps(global, has_gps);
    const std::vector<double> gaps = growing_gaps(global, length_s());
    progress_.stage("global registration",
                    static_cast<std::uint64_t>(global.odometry_iterations) + gaps.size() + last.size(), "iterations");
    // Far from its beginning the drive may have drifted by more than the fixes scatter.
    constexpr double kFirstGpsSlack = 16;
    for (int k = 0; k < global.odometry_iterations; ++k)
      RAYFIELD_CHECK(iterate({{}, has_gps, true, 0, kFirstGpsSlack}));
    for (const double gap : gaps) RAYFIELD_CHECK(iterate({{true, true, 0, gap}, has_gps, true, global.first_slack_m}));
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
    use_knots(step.coarse);
    RAYFIELD_CHECK(linearise(step.match, {step.slack_m, step.gps ? step.gps_slack : 0.0}, nullptr));
    RAYFIELD_ASSIGN(stats_.last_correction_m, problem_->solve_and_apply());
    progress_.advance(1);
    return {};
  }

  // Builds the normal equations at the present trajectory. With `statistics`, near matches are searched for again.
  Result<void> linearise(const MatchStep& step, const RegistrationWeights& weights, RevisitStatistics* statistics) {
    problem_->begin(weights);
    RAYFIELD_CHECK(matching_.match_regions(odometry_, problem_->surfel_offsets(), step, statistics != nullptr,
                                           [&](const RegionMatches& region) -> Result<void> {
                                             problem_->add_surfels(region.surfels, region.near, region.revisits);
                                             if (statistics)
                                               statistics->add(odometry_.track, region.surfels, region.revisits);
                                             return {};
                                           }));
    if (const PoleOptions& poles = options_.poles; step.revisits && poles.weight > 0) {
      problem_->add_poles({std::min(poles.max_reach_m, poles.reach_m + weights.slack_m), options_.global.revisit_gap_s,
                           step.max_gap_s});
    }
    problem_->end(stats_);
    return {};
  }

  void use_knots(bool coarse) {
    const int most = coarse ? options_.global.coarse_knots : options_.global.fine_knots;
    const double step_s = std::max(options_.global.knot_step_s, length_s() / most);
    if (problem_ && problem_->knot_step_s() == step_s) return;
    const RegistrationUnknowns unknowns =
        problem_ ? problem_->unknowns() : RegistrationUnknowns{.pole_depth_m = options_.poles.depth_m};
    problem_.emplace(odometry_, imu_, fixes_, rig_, options_, step_s, unknowns);
  }

  Result<void> measure(const Step& last, const std::vector<Eigen::Vector3d>& before_release) {
    problem_->measure_imu_misfit(stats_);
    use_knots(true);  // covariances need a factor of the whole system
    RevisitStatistics statistics(length_s());
    RAYFIELD_CHECK(linearise(last.match, {0.0, 0.0, true}, &statistics));
    RAYFIELD_CHECK(problem_->measure_uncertainty(stats_));
    stats_.thickness_count = statistics.count(), stats_.thickness_m = statistics.thickness_m();
    stats_.linked_sections = statistics.linked_sections(), stats_.revisits = statistics.misfit();
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
  std::optional<RegistrationProblem> problem_;
  RegionMatching matching_;
  RegistrationStats stats_;
};

}  // namespace

Result<RegistrationStats> register_globally(OdometryResult& odometry, const ImuGrid& imu,
                                            std::span<const GpsPosition> fixes, const Rig& rig,
                                            const SlamOptions& options, Progress& progress) {
  return Registration(odometry, imu, fixes, rig, options, progress).run();
}

}  // namespace rayfield::slam
