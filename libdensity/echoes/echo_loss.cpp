#include "libdensity/echoes/echo_loss.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "libdensity/echoes/echo_loss_table.h"

namespace rayfield::density {
namespace {

using namespace echo_loss_table;

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

}  // namespace

double returned_share(double diameter_sides, double detection_share, double optical_path) {
  const Place d = place_in(kDiameters, diameter_sides), s = place_in(kShares, detection_share);
  const Place p = place_in(kDepths, optical_path);
  double sum = 0;
  for (const std::size_t i : {0, 1})
    for (const std::size_t j : {0, 1})
      for (const std::size_t k : {0, 1})
        sum += (i == 1 ? d.share : 1 - d.share) * (j == 1 ? s.share : 1 - s.share) * (k == 1 ? p.share : 1 - p.share) *
               kReturned[d.low + i][s.low + j][p.low + k];
  return sum;
}

double mean_echo_share(double diameter_sides, double detection_share) {
  const Place d = place_in(kDiameters, diameter_sides), s = place_in(kShares, detection_share);
  double sum = 0;
  for (const std::size_t i : {0, 1})
    for (const std::size_t j : {0, 1})
      sum += (i == 1 ? d.share : 1 - d.share) * (j == 1 ? s.share : 1 - s.share) * kMeanShare[d.low + i][s.low + j];
  return sum;
}

}  // namespace rayfield::density
