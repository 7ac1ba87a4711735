#include "rayfield/experiments/turbid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/trials/trials.h"
#include "rayfield/density/estimator.h"

namespace rayfield::experiments {
namespace {

constexpr std::uint64_t kBatch = 4096;
constexpr double kG = 2;  // density over λ, of leaves of all directions

/// Sums over the rays of one trial.
struct Counts {
  std::uint64_t rays = 0, hits = 0;
  double path = 0, hit_path = 0;
};

/// Rays through a medium of rate λ; `depth` may be infinite.
Counts cast(int rays, double lambda, double depth, sim::CounterRandom& random) {
  Counts out;
  out.rays = static_cast<std::uint64_t>(rays);
  for (int i = 0; i < rays; ++i) {
    const double x = -std::log(random.uniform()) / lambda;
    out.path += std::min(x, depth);
    if (x < depth) ++out.hits, out.hit_path += x;
  }
  return out;
}

std::array<double, kTurbidEstimators> estimate_all(const Counts& c, double depth) {
  const auto n = static_cast<double>(c.rays), m = static_cast<double>(c.hits);
  return {m / (n * depth), m / c.path, std::max(m - 1, 0.0) / c.path,
          density::estimate_paper(c.rays, c.hits, c.path).density / kG, density::unbiased_rate(m, c.path, c.hit_path)};
}

struct Sums {
  std::array<Moments, kTurbidEstimators> errors;
  Sums& operator+=(const Sums& other) {
    for (std::size_t i = 0; i < errors.size(); ++i) errors[i] += other.errors[i];
    return *this;
  }
};

/// Normalised errors of all estimators; `cell` chooses the random numbers.
Result<Sums> simulate(const TurbidOptions& options, std::uint64_t cell, int rays, double lambda, double depth,
                      Progress& progress) {
  return sum_over_trials<Sums>(options.trials, kBatch, options.threads, {}, progress,
                               [&](std::uint64_t trial, Sums& sums) -> Result<void> {
                                 sim::CounterRandom random = trial_random(options.seed, cell, trial);
                                 const auto estimates = estimate_all(cast(rays, lambda, depth, random), depth);
                                 for (std::size_t i = 0; i < estimates.size(); ++i)
                                   sums.errors[i].add(estimates[i] / lambda - 1);
                                 return {};
                               });
}

const Moments& of(const Sums& sums, TurbidEstimator estimator) {
  return sums.errors[static_cast<std::size_t>(estimator)];
}

}  // namespace

Result<void> TurbidOptions::validate() const {
  RAYFIELD_CHECK(check_ranges("rays", {rays.begin(), rays.end()}, 2, 1000));
  RAYFIELD_CHECK(check_ranges("optical_depths", optical_depths, 0.001, 100));
  return check_range("trials", static_cast<double>(trials), 2, 1e9);
}

Result<TurbidResult> run_turbid(const TurbidOptions& options, Progress& progress) {
  RAYFIELD_CHECK(options.validate());
  TurbidResult result;
  std::uint64_t cell = 0;
  progress.stage("turbid medium", options.trials * options.rays.size() * (options.optical_depths.size() + 1), "trials");
  for (const int n : options.rays) {
    for (const double depth : options.optical_depths) {
      RAYFIELD_ASSIGN(const Sums sums, simulate(options, cell++, n, depth, 1, progress));
      TurbidCell out{n, depth, std::exp(-depth), {}, turbid_bias(n, depth)};
      for (std::size_t i = 0; i < kTurbidEstimators; ++i) out.simulated[i] = sums.errors[i].mean();
      result.cells.push_back(out);
    }
    const double endless = std::numeric_limits<double>::infinity();
    RAYFIELD_ASSIGN(const Sums sums, simulate(options, cell++, n, 1, endless, progress));
    const Moments& debiased = of(sums, TurbidEstimator::debiased);
    result.uncensored.push_back({n, of(sums, TurbidEstimator::maximum_likelihood).mean(), debiased.mean(),
                                 std::sqrt(debiased.variance()), 1 / std::sqrt(n - 2.0)});
  }
  return result;
}

}  // namespace rayfield::experiments
