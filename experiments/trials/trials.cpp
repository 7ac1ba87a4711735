#include "experiments/trials/trials.h"

#include <fmt/format.h>

namespace rayfield::experiments {

sim::CounterRandom trial_random(std::uint64_t seed, std::uint64_t cell, std::uint64_t trial) {
  return {seed, sim::Stream::experiment, (cell << 40) + trial};
}

Result<void> check_range(std::string_view key, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return fail(ErrorCode::usage, "cannot run the experiment", key,
              fmt::format("{} is outside {} … {}", value, low, high));
}

Result<void> check_ranges(std::string_view key, const std::vector<double>& values, double low, double high) {
  if (values.empty()) return fail(ErrorCode::usage, "cannot run the experiment", key, "there are no values");
  for (const double value : values) RAYFIELD_CHECK(check_range(key, value, low, high));
  return {};
}

tl::unexpected<Error> interrupted_experiment() {
  return fail(ErrorCode::interrupted, "interrupted", "experiment", "the user asked to stop");
}

}  // namespace rayfield::experiments
