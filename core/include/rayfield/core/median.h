#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace rayfield {

/// The upper median: for an even number of values the larger of the middle two; `otherwise` if there are none. No value
/// may be NaN.
inline double median_of(std::vector<double> values, double otherwise = std::numeric_limits<double>::quiet_NaN()) {
  if (values.empty()) return otherwise;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace rayfield
