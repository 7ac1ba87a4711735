#include "sim/terrain/smooth_noise.h"

#include <array>
#include <cmath>

namespace rayfield::sim {
namespace {

// Mean over one cell of the sum of squared cubic B-spline weights: the variance of blended unit white noise.
constexpr double kVariance = 151.0 / 315.0;

std::array<double, 4> cubic_weights(double u) {
  const double v = 1 - u;
  return {v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6, u * u * u / 6};
}

std::uint64_t lattice_index(std::int64_t ix, std::int64_t iy) {
  return mix64(static_cast<std::uint64_t>(ix) * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(iy));
}

}  // namespace

double smooth_noise(std::uint64_t seed, Stream stream, std::uint64_t channel, double x) {
  const double fx = std::floor(x);
  const auto w = cubic_weights(x - fx);
  const auto ix = static_cast<std::int64_t>(fx);
  const std::uint64_t channel_seed = seed + mix64(channel);
  double sum = 0;
  for (int i = 0; i < 4; ++i)
    sum += w[static_cast<std::size_t>(i)] * CounterRandom(channel_seed, stream, lattice_index(ix + i - 1, 0)).normal();
  return sum / std::sqrt(kVariance);
}

double smooth_noise(std::uint64_t seed, Stream stream, std::uint64_t channel, double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto wx = cubic_weights(x - fx), wy = cubic_weights(y - fy);
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
  const std::uint64_t channel_seed = seed + mix64(channel);
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)] *
             CounterRandom(channel_seed, stream, lattice_index(ix + i - 1, iy + j - 1)).normal();
  return sum / kVariance;
}

}  // namespace rayfield::sim
