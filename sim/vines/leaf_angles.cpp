#include "sim/vines/leaf_angles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rayfield::sim {
namespace {

constexpr int kIntegrationSteps = 9000;
constexpr int kQuantiles = 4096;

}  // namespace

double leaf_zenith_density(LeafAngles angles, double ellipsoid_ratio, double zenith) {
  const double s = std::sin(zenith), c = std::cos(zenith);
  switch (angles) {
    case LeafAngles::spherical:
      return s;
    case LeafAngles::planophile:
      return 1 + std::cos(2 * zenith);
    case LeafAngles::erectophile:
      return 1 - std::cos(2 * zenith);
    case LeafAngles::plagiophile:
      return 1 - std::cos(4 * zenith);
    case LeafAngles::extremophile:
      return 1 + std::cos(4 * zenith);
    case LeafAngles::uniform:
      return 1;
    case LeafAngles::ellipsoidal: {
      const double q = c * c + ellipsoid_ratio * ellipsoid_ratio * s * s;
      return s / (q * q);
    }
  }
  return s;
}

LeafNormals::LeafNormals(LeafAngles angles, double ellipsoid_ratio) {
  const double step = 0.5 * std::numbers::pi / kIntegrationSteps;
  std::vector<double> cumulative(kIntegrationSteps + 1, 0.0);
  for (int i = 0; i < kIntegrationSteps; ++i)
    cumulative[static_cast<std::size_t>(i) + 1] =
        cumulative[static_cast<std::size_t>(i)] + leaf_zenith_density(angles, ellipsoid_ratio, (i + 0.5) * step);
  std::size_t at = 0;
  for (int k = 0; k <= kQuantiles; ++k) {
    const double target = cumulative.back() * k / kQuantiles;
    while (at + 1 < cumulative.size() - 1 && cumulative[at + 1] < target) ++at;
    const double width = cumulative[at + 1] - cumulative[at];
    const double part = width > 0 ? std::clamp((target - cumulative[at]) / width, 0.0, 1.0) : 0.0;
    zenith_.push_back((static_cast<double>(at) + part) * step);
  }
}

Eigen::Vector3d LeafNormals::draw(CounterRandom& random) const {
  const double x = random.uniform() * kQuantiles;
  const auto i = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(kQuantiles - 1));
  const double zenith = zenith_[i] + (x - static_cast<double>(i)) * (zenith_[i + 1] - zenith_[i]);
  const double azimuth = 2 * std::numbers::pi * random.uniform();
  return {std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth), std::cos(zenith)};
}

}  // namespace rayfield::sim
