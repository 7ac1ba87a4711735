#include "libdensity/echoes/echo_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace rayfield::density {
namespace {

/// Echoes and pairs of some strength, width and distance.
void fill(EchoStatistics& statistics, LeafSizePairs* pairs, int count, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint16_t>(1 + 200 * uniform(rng));
    const auto second = static_cast<std::uint16_t>(1 + 200 * uniform(rng));
    const double distance = 0.08 * uniform(rng), delta = 0.4 * uniform(rng) - 0.2;
    const bool hit = uniform(rng) < 0.7;
    statistics.add_echo(first, 0.05 * uniform(rng));
    if (i % 5 == 0) statistics.add_full_echoes(std::vector{FullEcho{second, 0.01F, static_cast<float>(uniform(rng))}});
    if (i % 3 == 0) statistics.add_ground_echo(second, uniform(rng));
    if (i % 7 == 0) statistics.add_stem_echo(second, {i % 2 == 0, i % 3 == 0, i % 4 != 0});
    statistics.add_pair(first, second, distance, delta, hit);
    if (pairs != nullptr) pairs->add(distance, delta, hit);
  }
}

TEST(EchoStatistics, WithEveryEchoPairsAreThoseOfThinRays) {
  EchoStatistics statistics;
  LeafSizePairs pairs;
  fill(statistics, &pairs, 5000, 1);
  EXPECT_EQ(statistics.pairs_from(0), pairs);
  EXPECT_EQ(statistics.echoes(), 5000u);
}

TEST(EchoStatistics, WeakerEchoesAreWhereTheMiddleOfTheBeamWentPast) {
  EchoStatistics statistics;
  statistics.add_pair(100, 100, 0.012, 0.01, true);  // both on the leaf
  statistics.add_pair(100, 20, 0.012, 0.01, true);   // the second one half beside it: it goes on
  statistics.add_pair(20, 100, 0.012, 0.01, true);   // the first one is no leaf
  const PairCounts strong = counts_of(statistics.pairs_from(60), 0.05), all = counts_of(statistics.pairs_from(1), 0.05);
  EXPECT_EQ(strong.near[2], 2u);
  EXPECT_EQ(strong.same[2], 1u);
  EXPECT_EQ(all.near[2], 3u);
  EXPECT_EQ(all.same[2], 3u);
}

TEST(EchoStatistics, PartsMakeTheWhole) {
  EchoStatistics whole, first, second;
  fill(whole, nullptr, 700, 2);
  fill(whole, nullptr, 900, 3);
  fill(first, nullptr, 700, 2);
  fill(second, nullptr, 900, 3);
  first.merge(second);
  EXPECT_EQ(first, whole);
}

/// Ground whose echoes are 200·(1 − a·(1 − cosine)) strong.
EchoStatistics ground(double a, double least_cosine, int count = 20000) {
  EchoStatistics statistics;
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> cosine(least_cosine, 1);
  for (int i = 0; i < count; ++i) {
    const double c = cosine(rng);
    statistics.add_ground_echo(static_cast<std::uint16_t>(std::lround(200 * (1 - a * (1 - c)))), c);
  }
  return statistics;
}

TEST(EchoStatistics, TheGroundTellsHowEchoesDependOnTheAngle) {
  EXPECT_NEAR(ground(0, 0.3).ground_dependence().slope, 0, 0.01);
  EXPECT_NEAR(ground(0.7, 0.3).ground_dependence().slope, 0.7 / (1 - 0.7 * 0.2), 0.02);  // over the echo at 0.8
  EXPECT_LT(ground(0.7, 0.3).ground_dependence().error, AngleDependence{}.error);
}

TEST(EchoStatistics, GroundThatIsSeenFromOneAngleTellsNothing) {
  EXPECT_EQ(ground(0.7, 0.7).ground_dependence().slope, AngleDependence{}.slope);
  EXPECT_EQ(ground(0.7, 0.3, 2000).ground_dependence().error, AngleDependence{}.error);
}

}  // namespace
}  // namespace rayfield::density
