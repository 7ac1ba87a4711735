#include <gtest/gtest.h>

#include <cmath>

#include "rayfield/sim/random.h"

namespace rayfield::sim {
namespace {

// Bounds are five standard errors of the statistic under test.
constexpr int kDraws = 200000;

TEST(CounterRandom, UniformNumbersHaveTheMomentsOfTheUnitInterval) {
  double sum = 0, squares = 0, neighbours = 0, last = 0.5;
  for (int i = 0; i < kDraws; ++i) {
    const double x = CounterRandom(7, Stream::lidar, static_cast<std::uint64_t>(i)).uniform();
    ASSERT_GT(x, 0);
    ASSERT_LT(x, 1);
    sum += x, squares += x * x, neighbours += (x - 0.5) * (last - 0.5), last = x;
  }
  const double standard_error = 5 / std::sqrt(kDraws);
  EXPECT_NEAR(sum / kDraws, 0.5, standard_error * std::sqrt(1.0 / 12));
  EXPECT_NEAR(squares / kDraws, 1.0 / 3, standard_error * std::sqrt(4.0 / 45));
  EXPECT_NEAR(neighbours / kDraws, 0, standard_error / 12);
}

TEST(CounterRandom, NormalNumbersHaveUnitVarianceAndNoKurtosis) {
  CounterRandom random(1, Stream::gps);
  double sum = 0, squares = 0, fourth = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    sum += x, squares += x * x, fourth += x * x * x * x;
  }
  const double standard_error = 5 / std::sqrt(kDraws);
  EXPECT_NEAR(sum / kDraws, 0, standard_error);
  EXPECT_NEAR(squares / kDraws, 1, standard_error * std::sqrt(2));
  EXPECT_NEAR(fourth / kDraws, 3, standard_error * std::sqrt(96));
}

TEST(CounterRandom, StreamsSeedsAndIndicesGiveUnrelatedNumbers) {
  double streams = 0, seeds = 0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const double x = CounterRandom(3, Stream::leaf, i).uniform() - 0.5;
    streams += x * (CounterRandom(3, Stream::vine, i).uniform() - 0.5);
    seeds += x * (CounterRandom(4, Stream::leaf, i).uniform() - 0.5);
  }
  EXPECT_NEAR(streams / kDraws, 0, 5 / std::sqrt(kDraws) / 12);
  EXPECT_NEAR(seeds / kDraws, 0, 5 / std::sqrt(kDraws) / 12);
}

TEST(CounterRandom, TheSameKeyGivesTheSameNumbers) {
  CounterRandom a(9, Stream::imu, 12), b(9, Stream::imu, 12);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(a.bits(), b.bits());
}

}  // namespace
}  // namespace rayfield::sim
