#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace rayfield::density {

/// What the rays of a voxel met, by how steep they are and how wide their beam is: leaves that lie flat are met more
/// often by steep rays (docs/density.md, "How leaves are turned"). Integers, so that they do not depend on the order of
/// the rays.
struct DirectionCounters {
  static constexpr std::size_t kSteepness = 5, kWidths = 8, kBins = kSteepness * kWidths;
  /// |sine of the elevation| and beam diameter, m, where the next bin begins, and what stands for a bin.
  static constexpr std::array<double, kSteepness - 1> kSineEdges{0.1, 0.2, 0.3, 0.45};
  static constexpr std::array<double, kSteepness> kSine{0.05, 0.15, 0.25, 0.37, 0.6};
  static constexpr std::array<double, kWidths - 1> kWidthEdges_m{0.020, 0.026, 0.032, 0.038, 0.044, 0.052, 0.062};
  static constexpr std::array<double, kWidths> kWidth_m{0.016, 0.023, 0.029, 0.035, 0.041, 0.048, 0.057, 0.072};
  static constexpr double kPathUnit = 1.0 / (1 << 13);

  /// Of the bins [width · kSteepness + steepness].
  std::array<std::int64_t, kBins> path{};  ///< Σ length, voxel sides
  std::array<std::int64_t, kBins> hits{};  ///< number, or of beams that are not thin Σ intensity

  static std::size_t steepness_of(double sine) { return count_up_to(kSineEdges, std::abs(sine)); }
  static std::size_t bin_of(std::size_t steepness, double width_m) {
    return count_up_to(kWidthEdges_m, width_m) * kSteepness + steepness;
  }
  void add_path(std::size_t bin, double sides) { path[bin] += std::llrint(sides * (1 / kPathUnit)); }
  DirectionCounters& operator+=(const DirectionCounters& other) {
    for (std::size_t i = 0; i < kBins; ++i) path[i] += other.path[i], hits[i] += other.hits[i];
    return *this;
  }
  bool operator==(const DirectionCounters&) const = default;

 private:
  template <std::size_t N>
  static std::size_t count_up_to(const std::array<double, N>& edges, double x) {
    std::size_t count = 0;
    for (const double edge : edges) count += edge <= x ? 1 : 0;
    return count;
  }
};

}  // namespace rayfield::density
