#include "rayfield/formats/scale_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "formats/picture/color.h"

namespace rayfield::formats {
namespace {

/// Values below this share of the lowest end are not canopy: grass, noise.
constexpr double kNothing = 0.01;
constexpr double kShareAbove = 0.01;

/// Where the scale of a product may end at the least; 0 for products that are not fitted.
double lowest_end(std::string_view product) {
  constexpr std::array<std::pair<std::string_view, double>, 8> kEnds = {{{"plan_density", 5},
                                                                         {"leaf_density", 5},
                                                                         {"plan_density_se", 1},
                                                                         {"canopy_height", 2},
                                                                         {"leaf_area_per_m", 5},
                                                                         {"voxel_density", 5},
                                                                         {"side_view", 5},
                                                                         {"end_on", 3}}};
  for (const auto& [name, end] : kEnds)
    if (name == product) return end;
  return 0;
}

std::vector<double> ends_from(double lowest) {
  std::vector<double> ends;
  for (const double power : {1.0, 10.0, 100.0, 1000.0})
    for (const double factor : {1.0, 1.5, 2.0, 3.0, 5.0})
      if (lowest > 0 && factor * power >= lowest) ends.push_back(factor * power);
  return ends;
}

}  // namespace

ScaleFit::ScaleFit(std::string_view product)
    : product_(product),
      ends_(ends_from(lowest_end(product))),
      counts_(ends_.size() + 1, 0),
      low_(std::numeric_limits<double>::quiet_NaN()),
      high_(low_) {}

void ScaleFit::add(double value) {
  if (!std::isfinite(value)) return;
  low_ = std::fmin(low_, value), high_ = std::fmax(high_, value);
  if (ends_.empty() || value < kNothing * ends_.front()) return;
  ++counts_[static_cast<std::size_t>(std::lower_bound(ends_.begin(), ends_.end(), value) - ends_.begin())];
}

void ScaleFit::add(std::span<const float> values) {
  for (const float value : values) add(static_cast<double>(value));
}

void ScaleFit::end_date() {
  const std::uint64_t all = std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
  std::uint64_t above = all;
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    above -= counts_[i];
    if (static_cast<double>(above) > kShareAbove * static_cast<double>(all) && i + 1 < ends_.size()) continue;
    end_ = std::max(end_, i);
    break;
  }
  std::fill(counts_.begin(), counts_.end(), 0);
}

ColorScale ScaleFit::scale() const {
  ColorScale scale = product_scale(product_, low_, high_);
  if (!ends_.empty()) scale.low = 0, scale.high = ends_[end_];
  return scale;
}

}  // namespace rayfield::formats
