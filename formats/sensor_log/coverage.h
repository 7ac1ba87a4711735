#pragma once

#include <span>
#include <string>
#include <vector>

namespace rayfield::formats {

/// The time over which a sensor of a log delivered messages.
struct SensorSpan {
  std::string name;
  double first_s = 0, last_s = 0;
  double tolerance_s = 1;  ///< begin or end may differ by this much from the other sensors'
};

/// One line for each sensor that begins after, or ends before, the others by more than its tolerance, or whose stamps
/// have nothing in common with those of the first one (the reference).
std::vector<std::string> coverage_problems(std::span<const SensorSpan> sensors);

}  // namespace rayfield::formats
