#include "libdensity/echoes/wood_echoes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::density {
namespace {

EchoStatistics posts(int count) {
  EchoStatistics statistics;
  for (int i = 0; i < count; ++i) statistics.add_wood_echo(static_cast<std::uint16_t>(i % 2 == 0 ? 900 : 1100));
  return statistics;
}

TEST(WoodEchoes, PostsAreFull) {
  const auto echoes = wood_echoes(posts(1000), 500, 100);
  ASSERT_TRUE(echoes);
  EXPECT_NEAR(echoes->full_echo, 1000, 1e-9);
  EXPECT_FALSE(wood_echoes(posts(199), 500, 100));
  EXPECT_FALSE(wood_echoes(posts(1000), 500, 0));
}

// exp(−4.0/x³), x the mean over the weakest.
TEST(WoodEchoes, TheWeakerTheyAreTheMoreIsMissing) {
  const auto returned = [](double mean) { return wood_echoes(posts(1000), mean, 100)->returned_share; };
  EXPECT_NEAR(returned(200), std::exp(-4.0 / 8), 1e-9);
  EXPECT_NEAR(returned(300), std::exp(-4.0 / 27), 1e-9);
  EXPECT_GT(returned(1000), 0.99);
  EXPECT_NEAR(wood_echoes(posts(1000), 200, 100)->error, std::hypot(0.3, 0.4 * 4.0 / 8), 1e-9);
  EXPECT_EQ(returned(90), 0.25);  // a mean below the weakest cannot be
}

}  // namespace
}  // namespace rayfield::density
