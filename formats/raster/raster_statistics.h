#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rayfield::formats {

/// Statistics of the cells that are not NaN, over any number of calls; sums are taken in the order of the cells, about
/// the first value, so that they are repeatable and do not cancel for heights above sea level.
class RasterStatistics {
 public:
  void add(std::span<const float> values);

  double minimum() const;  ///< NaN where no cell has a value
  double maximum() const;
  double mean() const;
  double standard_deviation() const;  ///< of the population, as GDAL has it
  double valid_percent() const;

  /// GDAL's STATISTICS_* items; empty where no cell has a value.
  std::vector<std::pair<std::string, std::string>> metadata() const;

 private:
  std::uint64_t cells_ = 0, valid_ = 0;
  double shift_ = 0, sum_ = 0, sum_of_squares_ = 0, minimum_ = 0, maximum_ = 0;
};

}  // namespace rayfield::formats
