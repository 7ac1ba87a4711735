#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "libdensity/echoes/echo_model.h"

/// Echoes of leaves, posts and neighbouring beams, for tests of what they mean.
namespace rayfield::density {

inline constexpr EchoStatistics::OnStem kOnPost{.of_trunk = false, .is_full = true};

inline constexpr double kFull = 3000;

/// Echoes of beams `width_m` wide from leaves that are differently bright, each whole; pairs that tell no size.
inline EchoStatistics whole_leaves(double width_m, double share, int count = 20000) {
  EchoStatistics statistics;
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> bright(0.7, 1.3);
  for (int i = 0; i < count; ++i)
    statistics.add_echo(static_cast<std::uint16_t>(std::lround(kFull * share * bright(rng))), width_m);
  return statistics;
}

inline EchoKnowledge lidar(double width_m) { return {LidarBeam{width_m, 0, {}}, 0.15, 0, 0.0064}; }
/// Pairs of neighbouring beams 1 to 4 cm apart, most on one leaf.
inline void add_close_pairs(EchoStatistics& statistics) {
  const auto strong = static_cast<std::uint16_t>(kFull);
  for (int i = 0; i < 6000; ++i)
    statistics.add_pair(strong, strong, 0.012 + 0.005 * (i % 5), i % 4 == 0 ? 0.2 : 0, true),
        statistics.add_same_beam_beside();
}

/// Of the rays of add_close_pairs() 1500 go on within 4 cm of a hit; with `ends` more of which each ends 10 cm
/// behind it there are so many ends per metre behind hits.
inline double add_ends_behind(EchoStatistics& statistics, int ends) {
  const auto strong = static_cast<std::uint16_t>(kFull);
  for (int i = 0; i < ends; ++i) statistics.add_pair(strong, strong, 0.01, 0.1, true);
  return ends / (1500.0 + ends) / 0.1;
}

inline void add_posts(EchoStatistics& statistics, int echoes) {
  for (int i = 0; i < echoes; ++i) statistics.add_stem_echo(static_cast<std::uint16_t>(kFull), kOnPost);
}

}  // namespace rayfield::density
