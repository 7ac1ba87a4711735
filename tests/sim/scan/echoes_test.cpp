#include "sim/scan/echoes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace rayfield::sim {
namespace {

const auto kNoneLost = [](const Echo&) { return false; };

SiteLidar lidar_with(double share, double resolution, ReturnMode mode = ReturnMode::first) {
  SiteLidar lidar;
  lidar.detection_share = share;
  lidar.range_resolution_m = resolution;
  lidar.returns = mode;
  return lidar;
}

std::optional<Echo> returned(const SiteLidar& lidar, std::vector<SubEcho> hits, double dither = 0) {
  return beam_return(lidar, hits, dither, kNoneLost);
}

TEST(Echoes, TooLittleEnergyMakesNone) {
  const SiteLidar lidar = lidar_with(0.3, 0.1);
  EXPECT_FALSE(returned(lidar, {}));
  EXPECT_FALSE(returned(lidar, {{2.0, 0.29, 1}}));
  EXPECT_TRUE(returned(lidar, {{2.0, 0.30, 1}}));
}

TEST(Echoes, TheRangeIsTheMeanOfWhatLiesWithinTheResolutionInAnyOrder) {
  const auto echo = returned(lidar_with(0.3, 0.1), {{2.09, 0.3, 30}, {2.01, 0.1, 10}, {3.0, 0.5, 50}});
  ASSERT_TRUE(echo);
  EXPECT_DOUBLE_EQ(echo->range_m, (0.1 * 2.01 + 0.3 * 2.09) / 0.4);
  EXPECT_DOUBLE_EQ(echo->energy, 0.4);
  EXPECT_DOUBLE_EQ(echo->strength, 40);
}

// 0.15 + 0.15 and 0.15 + 0.2 lie close enough; only the second stretch is strong enough.
TEST(Echoes, AStretchMayBeginAtAnySurface) {
  const auto echo = returned(lidar_with(0.34, 0.1), {{2.00, 0.15, 1}, {2.09, 0.15, 1}, {2.18, 0.2, 1}});
  ASSERT_TRUE(echo);
  EXPECT_DOUBLE_EQ(echo->range_m, (0.15 * 2.09 + 0.2 * 2.18) / 0.35);
}

TEST(Echoes, WhatIsTooWeakLetsTheBeamGoOn) {
  const auto echo = returned(lidar_with(0.3, 0.1), {{2.0, 0.2, 1}, {2.5, 0.6, 1}});
  ASSERT_TRUE(echo);
  EXPECT_DOUBLE_EQ(echo->range_m, 2.5);
}

TEST(Echoes, ModesChooseAmongEchoes) {
  const std::vector<SubEcho> hits = {{2.0, 0.3, 1}, {3.0, 0.4, 1}, {4.0, 0.25, 1}};
  EXPECT_DOUBLE_EQ(returned(lidar_with(0.2, 0.1, ReturnMode::first), hits)->range_m, 2);
  EXPECT_DOUBLE_EQ(returned(lidar_with(0.2, 0.1, ReturnMode::strongest), hits)->range_m, 3);
  EXPECT_DOUBLE_EQ(returned(lidar_with(0.2, 0.1, ReturnMode::last), hits)->range_m, 4);
  EXPECT_DOUBLE_EQ(returned(lidar_with(0.28, 0.1, ReturnMode::last), hits)->range_m, 3);
}

TEST(Echoes, SeveralAreThoseFromTheFirstOnAsManyAsTheLidarReports) {
  std::vector<SubEcho> hits = {{2.0, 0.2, 20}, {2.5, 0.05, 5}, {3.0, 0.3, 30}, {4.0, 0.25, 25}, {5.0, 0.2, 20}};
  SiteLidar lidar = lidar_with(0.15, 0.1);
  for (const int most : {1, 2, 3, 8}) {
    lidar.echoes = most;
    std::vector<Echo> behind;
    const auto first = beam_return(lidar, hits, 0, kNoneLost, &behind);
    ASSERT_TRUE(first);
    EXPECT_DOUBLE_EQ(first->range_m, 2);           // as that of a lidar that reports nothing else
    const std::vector<double> ranges = {3, 4, 5};  // the sliver at 2.5 m is too weak
    ASSERT_EQ(behind.size(), std::min<std::size_t>(static_cast<std::size_t>(most) - 1, 3));
    for (std::size_t k = 0; k < behind.size(); ++k) EXPECT_DOUBLE_EQ(behind[k].range_m, ranges[k]);
  }
}

TEST(Echoes, WhatEndsWithinTheResolutionBehindAnEchoIsNoneOfItsOwn) {
  // Stretches from 2.00 and from 2.15 on, whose means are 8 cm apart.
  std::vector<SubEcho> hits = {{2.00, 0.1, 1}, {2.09, 0.2, 1}, {2.15, 0.3, 1}, {2.4, 0.3, 1}};
  SiteLidar lidar = lidar_with(0.25, 0.1);
  lidar.echoes = 5;
  std::vector<Echo> behind;
  EXPECT_NEAR(beam_return(lidar, hits, 0, kNoneLost, &behind)->range_m, 2.06, 1e-12);
  ASSERT_EQ(behind.size(), 1U);
  EXPECT_DOUBLE_EQ(behind[0].range_m, 2.4);
}

TEST(Echoes, AnEchoThatGetsLostLeavesTheNext) {
  std::vector<SubEcho> hits = {{2.0, 0.3, 1}, {3.0, 0.4, 1}};
  const auto echo = beam_return(lidar_with(0.2, 0.1), hits, 0, [](const Echo& e) { return e.range_m < 2.5; });
  ASSERT_TRUE(echo);
  EXPECT_DOUBLE_EQ(echo->range_m, 3);
}

TEST(Echoes, DitherDecidesWithinHalfASubRayOfTheThreshold) {
  const SiteLidar lidar = lidar_with(0.25, 0.1);
  EXPECT_TRUE(returned(lidar, {{2.0, 0.24, 1}}, 0.012));
  EXPECT_FALSE(returned(lidar, {{2.0, 0.26, 1}}, -0.012));
}

}  // namespace
}  // namespace rayfield::sim
