#pragma once

#include <algorithm>
#include <vector>

namespace rayfield::slam {

/// The upper median; 0 for no values.
inline double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace rayfield::slam
