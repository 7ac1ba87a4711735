#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace rayfield::density {

/// What the rays of a voxel met, by how steep they are and how far from the lidar: leaves that lie flat are met more
/// often by steep rays (docs/density.md, "How leaves are turned"). Integers, so that they do not depend on the order of
/// the rays.
struct DirectionCounters {
  static constexpr std::size_t kSteepness = 5, kRanges = 8, kBins = kSteepness * kRanges;
  /// |sine of the elevation| and range, m, where the next bin begins, and what stands for a bin.
  static constexpr std::array<double, kSteepness - 1> kSineEdges{0.1, 0.2, 0.3, 0.45};
  static constexpr std::array<double, kSteepness> kSine{0.05, 0.15, 0.25, 0.37, 0.6};
  static constexpr std::array<double, kRanges - 1> kRangeEdges_m{0.5, 1.0, 1.5, 2.0, 2.5, 3.2, 4.1};
  static constexpr std::array<double, kRanges> kRange_m{0.25, 0.75, 1.25, 1.75, 2.25, 2.85, 3.65, 4.9};
  static constexpr double kPathUnit = 1.0 / (1 << 13);

  /// Of the bins [range · kSteepness + steepness].
  std::array<std::int64_t, kBins> path{};  ///< Σ length, voxel sides
  std::array<std::int64_t, kBins> hits{};  ///< number, or of beams that are not thin Σ intensity

  static std::size_t steepness_of(double sine) { return count_up_to(kSineEdges, std::abs(sine)); }
  static std::size_t bin_of(std::size_t steepness, double range_m) {
    return count_up_to(kRangeEdges_m, range_m) * kSteepness + steepness;
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
