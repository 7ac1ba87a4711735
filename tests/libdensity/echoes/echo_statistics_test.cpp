#include "libdensity/echoes/echo_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

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
    if (i % 5 == 0) statistics.add_inner_echo(second, 0.05 * uniform(rng));
    if (i % 7 == 0) statistics.add_wood_echo();
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
  const LeafSizePairs strong = statistics.pairs_from(60), all = statistics.pairs_from(1);
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

TEST(EchoRun, InnerIsTheMiddleOneOfFiveOnASurface) {
  EchoRun run;
  for (int i = 1; i <= 4; ++i) EXPECT_FALSE(run.push({2.0 + 0.01 * i, 0.03, static_cast<std::uint16_t>(i)})) << i;
  EXPECT_TRUE(run.push({2.05, 0.03, 5}));
  EXPECT_EQ(run.inner_echo().intensity, 3);
  EXPECT_TRUE(run.push({2.05, 0.03, 6}));
  EXPECT_EQ(run.inner_echo().intensity, 4);
  EXPECT_FALSE(run.push({2.15, 0.03, 7}));  // a step: another surface
  for (int i = 8; i <= 10; ++i) EXPECT_FALSE(run.push({2.15, 0.03, static_cast<std::uint16_t>(i)})) << i;
  run.interrupt();
  for (int i = 1; i <= 4; ++i) EXPECT_FALSE(run.push({2.15, 0.03, 1})) << i;
  EXPECT_TRUE(run.push({2.15, 0.03, 1}));
}

}  // namespace
}  // namespace rayfield::density
