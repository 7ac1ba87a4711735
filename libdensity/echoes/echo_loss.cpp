#include "libdensity/echoes/echo_loss.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "libdensity/echoes/echo_loss_table.h"

namespace rayfield::density {
namespace {

using echo_loss_table::kMeanShare;
using echo_loss_table::kResolutionPaths;
using echo_loss_table::kReturned;
using echo_loss_table::kShares;

/// Place of a value between the steps of a table, clamped to its ends.
struct Place {
  std::size_t low = 0;
  double share = 0;  ///< of the next step
};

template <std::size_t N>
Place place_in(const std::array<double, N>& steps, double value) {
  std::size_t low = 0;
  while (low + 2 < N && steps[low + 1] <= value) ++low;
  return {low, std::clamp((value - steps[low]) / (steps[low + 1] - steps[low]), 0.0, 1.0)};
}

double weight_of(const Place& place, std::size_t next) { return next == 1 ? place.share : 1 - place.share; }

std::array<double, kResolutionPaths.size()> logarithms() {
  std::array<double, kResolutionPaths.size()> out{};
  std::transform(kResolutionPaths.begin(), kResolutionPaths.end(), out.begin(), [](double x) { return std::log(x); });
  return out;
}

}  // namespace

ReturnedShare::ReturnedShare(double detection_share, double resolution_path) {
  static_assert(echo_loss_table::kDiameters.size() == kDiameters && echo_loss_table::kDepths.size() == kDepths);
  const Place s = place_in(kShares, detection_share);
  const Place n = place_in(logarithms(), std::log(std::max(resolution_path, kResolutionPaths.front())));
  for (std::size_t d = 0; d < kDiameters; ++d)
    for (std::size_t p = 0; p < kDepths; ++p)
      for (const std::size_t i : {0, 1})
        for (const std::size_t j : {0, 1})
          returned_[d][p] += weight_of(n, i) * weight_of(s, j) * kReturned[d][n.low + i][s.low + j][p];
}

double ReturnedShare::operator()(double diameter_sides, double optical_path) const {
  const Place d = place_in(echo_loss_table::kDiameters, diameter_sides);
  const Place p = place_in(echo_loss_table::kDepths, optical_path);
  double sum = 0;
  for (const std::size_t i : {0, 1})
    for (const std::size_t k : {0, 1}) sum += weight_of(d, i) * weight_of(p, k) * returned_[d.low + i][p.low + k];
  return sum;
}

double mean_echo_share(double diameter_sides, double detection_share) {
  const Place d = place_in(echo_loss_table::kDiameters, diameter_sides), s = place_in(kShares, detection_share);
  double sum = 0;
  for (const std::size_t i : {0, 1})
    for (const std::size_t j : {0, 1}) sum += weight_of(d, i) * weight_of(s, j) * kMeanShare[d.low + i][s.low + j];
  return sum;
}

}  // namespace rayfield::density
