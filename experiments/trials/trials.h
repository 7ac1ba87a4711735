#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "rayfield/core/parallel.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/sim/random.h"

/// trials: how experiments are repeated, and what their repetitions say in the mean.
namespace rayfield::experiments {

/// Random numbers of one trial of one cell of a table (both below 2²⁴ and 2⁴⁰): a function of these alone.
sim::CounterRandom trial_random(std::uint64_t seed, std::uint64_t cell, std::uint64_t trial);

/// Refuses a number that is out of its range. Errors: usage.
Result<void> check_range(std::string_view key, double value, double low, double high);
Result<void> check_ranges(std::string_view key, const std::vector<double>& values, double low, double high);

/// What a user interrupted.
tl::unexpected<Error> interrupted_experiment();

/// Calls trial(index, sums) for the trials 0 … count − 1 and adds up what they put into their `sums`. A batch of trials
/// has sums of its own, in the order of its trials; batches run in parallel and are added in their order, so that the
/// result is the same at any number of threads. Errors: interrupted, and what a trial returns.
template <class Sums>
Result<Sums> sum_over_trials(std::uint64_t count, std::uint64_t batch, int threads, const Sums& zero,
                             Progress& progress,
                             const std::function<Result<void>(std::uint64_t trial, Sums& sums)>& trial) {
  std::vector<Sums> batches((count + batch - 1) / batch, zero);
  RAYFIELD_CHECK(parallel_for(batches.size(), thread_count(threads), [&](std::size_t b, int) -> Result<void> {
    if (progress.cancelled()) return interrupted_experiment();
    const std::uint64_t first = b * batch, last = std::min(count, first + batch);
    for (std::uint64_t t = first; t < last; ++t) RAYFIELD_CHECK(trial(t, batches[b]));
    progress.advance(last - first);
    return {};
  }));
  Sums sums = zero;
  for (const Sums& part : batches) sums += part;
  return sums;
}

}  // namespace rayfield::experiments
