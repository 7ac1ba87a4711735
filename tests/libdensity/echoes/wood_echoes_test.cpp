#include "libdensity/echoes/wood_echoes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::density {
namespace {

constexpr EchoStatistics::OnStem kOnPost{.of_trunk = false, .is_full = true};

EchoStatistics posts(int count) {
  EchoStatistics statistics;
  for (int i = 0; i < count; ++i)
    statistics.add_stem_echo(static_cast<std::uint16_t>(i % 2 == 0 ? 900 : 1100), kOnPost);
  return statistics;
}

TEST(WoodEchoes, PostsAreFull) {
  const auto echoes = wood_echoes(posts(1000), 500, 100);
  ASSERT_TRUE(echoes);
  EXPECT_NEAR(echoes->full_echo, 1000, 1e-9);
  EXPECT_FALSE(wood_echoes(posts(199), 500, 100));
  EXPECT_FALSE(wood_echoes(posts(1000), 500, 0));
}

/// Echoes on stems, evenly between two strengths; one in ten of a beam that fell wholly on one, in the middle of them.
void add_stems(EchoStatistics& statistics, bool of_trunk, int count, int from, int to) {
  for (int i = 0; i < count; ++i) {
    statistics.add_stem_echo(static_cast<std::uint16_t>(from + (to - from) * i / (count - 1)), {.of_trunk = of_trunk});
    if (i % 10 == 0)
      statistics.add_stem_echo(static_cast<std::uint16_t>((from + to) / 2), {of_trunk, true, /*above_grass=*/false});
  }
}

TEST(WoodEchoes, CanesAreAsBrightAsTrunks) {
  for (const double trunks_over_posts : {0.6, 1.0, 1.5}) {
    EchoStatistics statistics;
    add_stems(statistics, false, 3000, 500, 1500);
    const auto scaled = [&](int strength) { return static_cast<int>(std::lround(trunks_over_posts * strength)); };
    add_stems(statistics, true, 1000, scaled(500), scaled(1500));
    EXPECT_NEAR(wood_echoes(statistics, 500, 100)->full_echo, 1000 * trunks_over_posts, 2);
  }
}

TEST(WoodEchoes, FewTrunksTellNothingOfBrightness) {
  EchoStatistics statistics;
  add_stems(statistics, false, 3000, 500, 1500);
  add_stems(statistics, true, 90, 200, 600);
  EXPECT_NEAR(wood_echoes(statistics, 500, 100)->full_echo, (300 * 1000 + 9 * 400) / 309.0, 1e-9);  // all full ones
}

TEST(WoodEchoes, TrunksFarBrighterThanPostsAreDoubted) {
  EchoStatistics statistics;
  add_stems(statistics, false, 3000, 500, 1500);
  add_stems(statistics, true, 3000, 5000, 15000);
  EXPECT_NEAR(wood_echoes(statistics, 500, 100)->full_echo, 2500, 1);
}

TEST(WoodEchoes, WhatGrowsAtTheFootDoesNotCount) {
  EchoStatistics statistics;
  add_stems(statistics, false, 3000, 500, 1500);
  add_stems(statistics, true, 1000, 500, 1500);
  for (int i = 0; i < 1000; ++i) statistics.add_stem_echo(9000, {true, false, /*above_grass=*/false});
  EXPECT_NEAR(wood_echoes(statistics, 500, 100)->full_echo, 1000, 2);
}

/// Posts and trunks of the same 330 and 110 full echoes of 1000 and 600.
EchoStatistics dark_trunks() {
  EchoStatistics statistics;
  add_stems(statistics, false, 3000, 500, 1500);
  add_stems(statistics, true, 1000, 300, 900);
  return statistics;
}

TEST(WoodEchoes, WoodIsAsBrightBesideLeavesAsTrunksAre) {
  EXPECT_NEAR(wood_brightness(dark_trunks(), 1000).value, 0.6, 0.002);
  EXPECT_EQ(wood_brightness(dark_trunks(), 1000).error, 0);
  EXPECT_NEAR(wood_brightness(dark_trunks(), 500).value, 1.2, 0.004);
  EXPECT_EQ(wood_brightness(dark_trunks(), 2000).value, 0.4);  // doubted
  EXPECT_EQ(wood_brightness(dark_trunks(), 100).value, 1.6);
}

TEST(WoodEchoes, PostsAloneDoNotTellHowBrightWoodIs) {
  EXPECT_EQ(wood_brightness(posts(1000), 2000).value, 1);
  EXPECT_EQ(wood_brightness(posts(1000), 2000).error, 0.3);
}

TEST(WoodEchoes, TrunksWithoutPostsTellItLessWell) {
  EchoStatistics statistics;
  add_stems(statistics, true, 3000, 300, 900);  // 300 full ones of 600
  EXPECT_NEAR(wood_brightness(statistics, 1000).value, 1.1 * 0.6, 1e-9);
  EXPECT_EQ(wood_brightness(statistics, 1000).error, 0.06);
  EchoStatistics fewer;
  add_stems(fewer, true, 1900, 300, 900);  // 190
  EXPECT_EQ(wood_brightness(fewer, 1000).value, 1);
}

TEST(WoodEchoes, WoodUnlikeLeavesIsInAreasTheMoreTheFewerLeavesThereAre) {
  EchoStatistics statistics = dark_trunks();
  const auto full = static_cast<double>(statistics.wood().count);
  for (int i = 0; i < 20 * full; ++i) statistics.add_echo(700, 0.03);
  EXPECT_NEAR(wood_error(statistics, 1000), 0.6 * 2.5 / 20 * 0.4, 1e-4);  // darker
  EXPECT_NEAR(wood_error(statistics, 500), 0.6 * 2.5 / 20 * 0.2, 1e-4);   // brighter
  for (int i = 0; i < 20 * full; ++i) statistics.add_echo(700, 0.03);
  EXPECT_NEAR(wood_error(statistics, 1000), 0.6 * 2.5 / 40 * 0.4, 1e-4);
  EXPECT_EQ(wood_error(EchoStatistics(), 1600), 0);
}

TEST(WoodEchoes, WhatIsNotKnownOfWoodIsInAreas) {
  EchoStatistics of_posts = posts(300);
  for (int i = 0; i < 20 * 300; ++i) of_posts.add_echo(700, 0.03);
  EXPECT_NEAR(wood_error(of_posts, 1600), 2.5 / 20 * 0.3, 1e-9);
  EchoStatistics of_leaves;
  of_leaves.add_echo(700, 0.03);
  EXPECT_NEAR(wood_error(of_leaves, 1600), 0.15 * 0.3, 1e-9);
  EchoStatistics of_trunks;
  add_stems(of_trunks, true, 3000, 300, 900);
  for (int i = 0; i < 20 * 300; ++i) of_trunks.add_echo(700, 0.03);
  EXPECT_NEAR(wood_error(of_trunks, 1000), 2.5 / 20 * std::hypot(0.6 * 0.34, 0.06), 1e-9);
}

// exp(−3.3/x³), x the mean over the weakest.
TEST(WoodEchoes, TheWeakerTheyAreTheMoreIsMissing) {
  const auto returned = [](double mean) { return wood_echoes(posts(1000), mean, 100)->returned_share; };
  EXPECT_NEAR(returned(200), std::exp(-3.3 / 8), 1e-9);
  EXPECT_NEAR(returned(300), std::exp(-3.3 / 27), 1e-9);
  EXPECT_GT(returned(1000), 0.99);
  EXPECT_NEAR(wood_echoes(posts(1000), 200, 100)->error, std::hypot(0.15, 0.3 * 3.3 / 8), 1e-9);
  EXPECT_EQ(returned(90), 0.25);  // a mean below the weakest cannot be
}

}  // namespace
}  // namespace rayfield::density
