#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace rayfield::sim {

/// What a random number is drawn for. Each stream is independent of the others, so that adding leaves never moves a
/// post. Values are part of what makes a site reproducible: append, never renumber.
enum class Stream : std::uint64_t {
  terrain_relief = 1,
  terrain_roughness = 2,
  grass = 3,
  row_vigour = 4,
  vine = 5,
  leaf = 6,
  cane = 7,
  trunk = 8,
  tree = 9,
  building = 10,
  lane_wander = 11,
  wheel_bump = 12,
  vibration = 13,
  speed = 14,
  lidar = 15,
  encoder = 16,
  imu = 17,
  imu_bias = 18,
  gps = 19,
  gps_bias = 20,
  experiment = 21,
  wind = 22,
  disturbance = 23,
  speckle = 24,
};

/// Finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection of 64-bit words in which every input bit changes
/// every output bit with probability close to one half.
constexpr std::uint64_t mix64(std::uint64_t x) {
  x ^= x >> 30, x *= 0xbf58476d1ce4e5b9ULL;
  x ^= x >> 27, x *= 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Random numbers as a pure function of (seed, stream, index, draw): draw k is mix64(key + k·γ), which is SplitMix64
/// started at the key. Objects are cheap; one is made for each ray, leaf or sample, so nothing depends on the order or
/// on the thread in which they are made.
class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, Stream stream, std::uint64_t index = 0)
      : key_(mix64(mix64(mix64(seed + kGamma) + static_cast<std::uint64_t>(stream) * kGamma) + index * kGamma)) {}

  std::uint64_t bits() { return mix64(key_ += kGamma); }
  /// Uniform in the open interval (0, 1), multiples of 2⁻⁵³ plus half of one.
  double uniform() { return (static_cast<double>(bits() >> 11) + 0.5) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal (Box–Muller; two draws).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }
  Eigen::Vector3d normal3() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

 private:
  static constexpr std::uint64_t kGamma = 0x9e3779b97f4a7c15ULL;
  std::uint64_t key_;
};

}  // namespace rayfield::sim
