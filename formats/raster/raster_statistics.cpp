#include "formats/raster/raster_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayfield::formats {

void RasterStatistics::add(std::span<const float> values) {
  for (const float cell : values) {
    ++cells_;
    if (std::isnan(cell)) continue;
    const double value = static_cast<double>(cell);
    if (valid_ == 0) shift_ = minimum_ = maximum_ = value;
    ++valid_;
    minimum_ = std::min(minimum_, value);
    maximum_ = std::max(maximum_, value);
    sum_ += value - shift_;
    sum_of_squares_ += (value - shift_) * (value - shift_);
  }
}

double RasterStatistics::minimum() const { return valid_ > 0 ? minimum_ : std::numeric_limits<double>::quiet_NaN(); }
double RasterStatistics::maximum() const { return valid_ > 0 ? maximum_ : std::numeric_limits<double>::quiet_NaN(); }
double RasterStatistics::mean() const { return shift_ + sum_ / static_cast<double>(valid_); }

double RasterStatistics::standard_deviation() const {
  const double mean_shifted = sum_ / static_cast<double>(valid_);
  return std::sqrt(std::max(0.0, sum_of_squares_ / static_cast<double>(valid_) - mean_shifted * mean_shifted));
}

double RasterStatistics::valid_percent() const {
  return cells_ > 0 ? 100.0 * static_cast<double>(valid_) / static_cast<double>(cells_) : 0.0;
}

std::vector<std::pair<std::string, std::string>> RasterStatistics::metadata() const {
  if (valid_ == 0) return {};
  return {{"STATISTICS_MINIMUM", fmt::format("{}", minimum())},
          {"STATISTICS_MAXIMUM", fmt::format("{}", maximum())},
          {"STATISTICS_MEAN", fmt::format("{}", mean())},
          {"STATISTICS_STDDEV", fmt::format("{}", standard_deviation())},
          {"STATISTICS_VALID_PERCENT", fmt::format("{:.4g}", valid_percent())}};
}

}  // namespace rayfield::formats
