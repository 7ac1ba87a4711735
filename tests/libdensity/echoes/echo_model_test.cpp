#include "libdensity/echoes/echo_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "libdensity/echoes/wood_echoes.h"
#include "tests/libdensity/echoes/leaf_echoes.h"

namespace rayfield::density {
namespace {

TEST(EchoModel, SaysHowEchoesVaryAndHowWideBeamsAre) {
  const auto model = estimate_echo_model(whole_leaves(0.001, 1), lidar(0.001));
  ASSERT_TRUE(model.has_value());
  EXPECT_NEAR(model->echo_variation, 0.03, 0.002);  // of 0.7 … 1.3, evenly
  EXPECT_NEAR(model->mean_width_m, 0.001, 1e-9);
}

/// Of whole_leaves(), over their mean, the strength that a share of them does not reach, of 0.7 … 1.3, evenly.
constexpr double strength(double share) { return 0.7 + 0.6 * share; }
/// Of the mean echo, where the angle dependence is 0.35 ± 0.35.
const double kMeanError = std::hypot(0.04, 0.05 * 0.35);

/// exp(0.47 + (0.04 + 0.71·D/s)·exp(−0.75·n) − 0.05·slope − 0.54·I₂/Ī − 0.43·ln(I₂₀/Ī) − 1.02·ln(I₄₀/Ī) −
/// 1.24·ln(I₉₀/Ī)) of whole_leaves(), I₂ the strength that 2 % of the echoes do not reach, n how many leaves stand in
/// one range resolution.
double above_mean(double widths, double leaves_per_resolution, double slope = 0.35) {
  return std::exp(0.47 + (0.04 + 0.71 * widths) * std::exp(-0.75 * leaves_per_resolution) - 0.05 * slope -
                  0.54 * strength(0.02) - 0.43 * std::log(strength(0.2)) - 1.02 * std::log(strength(0.4)) -
                  1.24 * std::log(strength(0.9)));
}

TEST(EchoModel, AFullEchoIsAboveTheMeanByTheWidthAndByHowEchoesAreSpread) {
  double per_metre = 0;
  const auto full_of = [&](double width_m, double range_resolution_m, std::uint64_t wood) {
    EchoStatistics statistics = whole_leaves(width_m, 0.5);
    add_close_pairs(statistics);
    per_metre = add_ends_behind(statistics, 750);
    for (std::uint64_t i = 0; i < wood; ++i) statistics.add_stem_echo(static_cast<std::uint16_t>(kFull / 2), kOnPost);
    EchoKnowledge known = lidar(width_m);
    known.range_resolution_m = range_resolution_m;
    return *estimate_echo_model(statistics, known);
  };
  const auto above = [&](double width_m, double range_resolution_m) {
    return kFull / 2 * above_mean(width_m / 0.08, per_metre * range_resolution_m);
  };
  for (const double width_m : {0.015, 0.025, 0.035})  // middles of bins
    for (const double range_resolution_m : {0.1, 0.3}) {
      const EchoModel model = full_of(width_m, range_resolution_m, 0);
      EXPECT_NEAR(model.full_echo, above(width_m, range_resolution_m), 0.003 * kFull);
      EXPECT_NEAR(model.leaves_per_resolution, range_resolution_m / 0.3, 1e-9);  // 750 of 2250 in 10 cm
    }
  EXPECT_NEAR(full_of(0.025, 0.1, 1000).full_echo, above(0.025, 0.1), 0.003 * kFull);
  EXPECT_NEAR(full_of(0.025, 0.1, 1000).full_echo_error, std::hypot(kMeanError, 0.7 / 20, 0.5 / 20), 1e-3);
}

// No simulated scan has a full echo below the mean one, or above 1.7 of it.
TEST(EchoModel, NoSpreadOfStrengthsPutsAFullEchoFarAboveTheMean) {
  const auto full_over_mean = [](double strong_share) {
    EchoStatistics statistics;
    for (int i = 0; i < 20000; ++i) statistics.add_echo(i < 20000 * strong_share ? 3000 : 300 + i % 7, 0.025);
    const double mean = strong_share * 3000 + (1 - strong_share) * 303;
    return estimate_echo_model(statistics, lidar(0.025))->full_echo / mean;
  };
  EXPECT_NEAR(full_over_mean(0.5), std::exp(0.7), 1e-3);
  EXPECT_NEAR(full_over_mean(0.05), std::exp(0.7), 1e-3);
  EXPECT_GE(full_over_mean(0.999), 1 - 1e-3);
}

// Seven of ten echoes hold a sixth to a third of a leaf's: by the mean a full echo would be 0.7 of it.
TEST(EchoModel, WhereMostEchoesAreOfPiecesOfCanesBrightOnesTellAFullEcho) {
  EchoStatistics statistics = whole_leaves(0.025, 0.5, 9000);
  for (int i = 0; i < 21000; ++i)
    statistics.add_echo(static_cast<std::uint16_t>(kFull / 2 * (0.15 + 0.15 * i / 21000)), 0.025);
  add_close_pairs(statistics);
  add_ends_behind(statistics, 750);
  // Of the bright tenths what 0.7 … 1.3 have.
  const double i98 = strength(1 - 0.02 / 0.3), i90 = strength(1 - 0.1 / 0.3), i80 = strength(1 - 0.2 / 0.3);
  const double bright = i98 * std::exp(-0.112 + 4.235 * std::log(i90 / i98) - 1.748 * std::log(i80 / i98) -
                                       0.16 * 0.35 + 0.235 * 0.025 / 0.08);
  EXPECT_NEAR(bright, 1.16, 0.01);
  EXPECT_NEAR(estimate_echo_model(statistics, lidar(0.025))->full_echo, 0.9 * bright * kFull / 2, 0.01 * kFull / 2);
}

TEST(EchoModel, FullEchoesAndTheMeanEchoCountByTheirErrors) {
  EchoStatistics statistics = whole_leaves(0.025, 0.5);
  add_close_pairs(statistics);
  const auto of_mean = estimate_echo_model(statistics, lidar(0.025));
  const auto model_with = [&](std::size_t count) {
    EchoStatistics more = statistics;
    for (std::size_t i = 0; i < count; ++i) {
      const auto cosine = static_cast<float>(0.6 + 0.4 * static_cast<double>(i) / static_cast<double>(count));
      const double off = 700 * std::sin(2.4 * static_cast<double>(i));  // a scatter of a sixth
      FullEcho full{static_cast<std::uint16_t>(kFull + off), 0.01F, cosine};
      full.half_cosine.fill({cosine, cosine});
      more.add_full_echoes(std::vector{full});
    }
    return *estimate_echo_model(more, lidar(0.025));
  };
  EXPECT_EQ(model_with(9).full_echo, of_mean->full_echo);
  const double few = model_with(12).full_echo, many = model_with(4000).full_echo;
  // Many full echoes know that there is no angle dependence, too.
  const double weight = 1 / (0.04 * 0.04), with_slope = kFull / 2 * above_mean(0.025 / 0.08, 0, 0);
  const double expected = (kFull + with_slope) / 2;
  EXPECT_NEAR(many, expected, 0.02 * kFull);
  EXPECT_GT(std::abs(few - of_mean->full_echo), 0.2 * std::abs(many - of_mean->full_echo));
  EXPECT_LT(std::abs(few - of_mean->full_echo), 0.8 * std::abs(many - of_mean->full_echo));
  // They differ by ten times what their errors say, and so is the error of what comes of them.
  const double apart = std::log(kFull / with_slope) / std::hypot(0.04, 0.04);
  EXPECT_GT(apart, 8);
  EXPECT_NEAR(model_with(4000).full_echo_error, apart / std::sqrt(2 * weight), 0.03);
}

// Beams that fall wholly on a leaf are rare where they are as wide, and many that look like it are not.
TEST(EchoModel, FullEchoesLackTheMoreTheWiderTheBeamBesideTheLeaf) {
  const auto model_of = [](double width_m, double detection_share, double range_resolution_m) {
    EchoStatistics statistics = whole_leaves(width_m, 0.5);
    add_close_pairs(statistics);
    for (int i = 0; i < 4000; ++i) {
      const auto cosine = static_cast<float>(0.6 + 0.0001 * i);
      FullEcho full{static_cast<std::uint16_t>(kFull), 0.01F, cosine};
      full.half_cosine.fill({cosine, cosine});
      statistics.add_full_echoes(std::vector{full});
    }
    EchoKnowledge known = lidar(width_m);
    known.beam.detection_share = detection_share, known.range_resolution_m = range_resolution_m;
    return *estimate_echo_model(statistics, known);
  };
  for (const double width_m : {0.005, 0.025, 0.045})  // middles of bins; s = 80 mm
    for (const double detection_share : {0.25, 0.4})
      for (const double range_resolution_m : {0.15, 0.3}) {
        const EchoModel model = model_of(width_m, detection_share, range_resolution_m);
        const double lacks =
            1.8 * std::pow(width_m / 0.08, 2.5) * std::exp(-range_resolution_m / 0.15 - detection_share / 0.3);
        EXPECT_NEAR(model.lacking_share, lacks, 1e-3);
        // The mean echo counts by its error of 4 %, full ones by 4 % and half of what they lack. No two leaves stand
        // within one range resolution here, and the angle does not count.
        const double full_weight = 1 / (0.04 * 0.04 + 0.25 * lacks * lacks), mean_weight = 1 / (0.04 * 0.04);
        const double of_mean = kFull / 2 * above_mean(width_m / 0.08, 0, 0);
        const double expected =
            (full_weight * kFull / (1 - lacks) + mean_weight * of_mean) / (full_weight + mean_weight);
        EXPECT_NEAR(model.full_echo, expected, 0.01 * kFull);
      }
}

// One in twelve of the echoes is on a post or trunk.
TEST(EchoModel, KnowsWoodFromTrunksAndHowMuchThereIsBeforehand) {
  EchoStatistics statistics = whole_leaves(0.025, 0.5);
  add_close_pairs(statistics);
  for (int i = 0; i < 400; ++i)
    for (const bool of_trunk : {false, true})
      statistics.add_stem_echo(static_cast<std::uint16_t>((of_trunk ? 0.3 : 0.6) * kFull), {of_trunk, true, true});
  EchoKnowledge known = lidar(0.025);
  const EchoModel without = *estimate_echo_model(statistics, known);
  EXPECT_EQ(without.wood_per_side, 0);
  EXPECT_EQ(without.wood_error, 0);  // there is none
  known.wood_per_side = 0.18;
  const EchoModel model = *estimate_echo_model(statistics, known);
  EXPECT_EQ(model.wood_per_side, 0.18);
  EXPECT_NEAR(model.wood_brightness * model.full_echo, 0.3 * kFull, 2);
  EXPECT_NEAR(model.wood_error, wood_error(statistics, model.full_echo), 1e-12);
  EXPECT_EQ(with_wood_as_leaves(model).wood_per_side, 0);
}

// Leaves that lie flat are met at a smaller cosine by level rays, and their full echo is weaker.
TEST(EchoModel, TheFullEchoGoesWithTheAnglesAtWhichRaysMeetLeaves) {
  EchoModel model{.full_echo = 100, .detection_share = 0.2, .full_echo_per_cosine = 60, .wood_brightness = 0.6};
  EXPECT_NEAR(with_aspect(model, {}).full_echo, 100, 1e-9);
  const EchoModel flat = with_aspect(model, {2.0 / 3 - 0.2, 1});
  EXPECT_NEAR(flat.full_echo, 88, 1e-9);
  EXPECT_NEAR(flat.detection_share, 0.2 / 0.88, 1e-9);  // the weakest echo is as it was
  EXPECT_NEAR(flat.wood_brightness, 0.6 / 0.88, 1e-9);  // and so is wood's
  model.beam.detection_share = 0.2;
  EXPECT_EQ(with_aspect(model, {2.0 / 3 - 0.2, 1}).detection_share, 0.2);
  model.full_echo_per_cosine = 1000;
  EXPECT_NEAR(with_aspect(model, {0.4, 1}).full_echo, 50, 1e-9);
}

// Leaves that look too small are larger than that, so that full echoes lack less.
TEST(EchoModel, LeavesThatLieFlatAreLargerThanTheyLook) {
  EchoModel model{.full_echo = 100, .leaf_size_m2 = 0.0036, .leaf_size_from = LeafSizeFrom::pairs};
  model.mean_width_m = 0.03, model.range_resolution_m = 0.15, model.detection_share = 0.25;
  const auto lacking = [&](double side_m) {
    return 1.8 * std::pow(model.mean_width_m / side_m, 2.5) * std::exp(-1 - 0.25 / 0.3);
  };
  model.lacking_share = lacking(0.06);
  const EchoModel flat = with_aspect(model, {2.0 / 3, 0.75});
  EXPECT_NEAR(flat.leaf_size_m2, 0.0064, 1e-9);
  EXPECT_NEAR(flat.full_echo, 100 * (1 - lacking(0.06)) / (1 - lacking(0.08)), 1e-6);
  EXPECT_NEAR(flat.lacking_share, lacking(0.08), 1e-9);
  model.mean_echo_weight = 0.4, model.leaves_per_resolution = 0.6;  // 0.71·(D/s)·exp(−0.75·n)
  const double of_mean = std::exp(0.71 * (0.03 / 0.08 - 0.03 / 0.06) * std::exp(-0.75 * 0.6));
  EXPECT_NEAR(with_aspect(model, {2.0 / 3, 0.75}).full_echo, 0.6 * flat.full_echo + 0.4 * 100 * of_mean, 1e-6);
  model.leaf_size_from = LeafSizeFrom::options;
  EXPECT_EQ(with_aspect(model, {2.0 / 3, 0.75}).leaf_size_m2, 0.0036);
  EXPECT_NEAR(with_aspect(model, {2.0 / 3, 0.75}).full_echo, 100, 1e-9);
}

TEST(EchoModel, FullEchoesTellHowTheyGoWithTheAngle) {
  const double at_random = 0.3 + 0.7 * 2 / 3, slope = 0.7 / (0.3 + 0.7 * 0.6);  // over the median, at a cosine of 0.6
  EchoStatistics statistics = whole_leaves(0.03, at_random / above_mean(0.03 / 0.08, 0, slope));  // the same full echo
  add_close_pairs(statistics);
  for (int i = 0; i < 4000; ++i) {
    const auto cosine = static_cast<float>(0.4 + 0.0001 * i);
    FullEcho full{static_cast<std::uint16_t>(kFull * (0.3 + 0.7 * static_cast<double>(cosine))), 0.01F, cosine};
    full.half_cosine.fill({cosine, cosine});
    statistics.add_full_echoes(std::vector{full});
  }
  const auto model = estimate_echo_model(statistics, lidar(0.03));
  EXPECT_NEAR(model->full_echo, kFull * at_random, 0.03 * kFull);
  const double full_weight = 1 / (0.04 * 0.04), mean_weight = 1 / (0.04 * 0.04);  // the mean echo says nothing of it
  EXPECT_NEAR(model->full_echo_per_cosine, 0.7 * kFull * full_weight / (full_weight + mean_weight), 0.1 * kFull);
}

TEST(EchoModel, LidarsWithOneBeamAreToldByThePreviousBeam) {
  EchoStatistics statistics = whole_leaves(0.03, 0.5);
  EXPECT_FALSE(sends_one_beam(statistics));
  add_close_pairs(statistics);
  EXPECT_TRUE(sends_one_beam(statistics));
}

// The same pairs of echoes: where what lies farther behind is in an echo, too, leaves are larger than they look.
TEST(EchoModel, LeavesLookSmallerThroughCoarserRangeResolutions) {
  EchoStatistics statistics = whole_leaves(0.03, 0.5);
  add_close_pairs(statistics);
  EchoKnowledge known = lidar(0.03);
  known.leaf_size_m2 = -1;
  const auto area_m2 = [&](double range_resolution_m) {
    known.range_resolution_m = range_resolution_m;
    const auto model = estimate_echo_model(statistics, known);
    EXPECT_EQ(model->leaf_size_from, LeafSizeFrom::pairs);
    return model->leaf_size_m2;
  };
  EXPECT_NEAR(area_m2(0.25) / area_m2(0.15), std::exp(2 * 3.03 * 0.1), 1e-6);
  EXPECT_EQ(area_m2(0.5), area_m2(0.4));
}

// One range in two pairs of depths, 7 cm apart: what lidars with several beams take for one leaf, and others do not.
TEST(EchoModel, LeavesOfSeveralBeamsAreLookedForInWiderWindowsAndFartherOff) {
  EchoStatistics several = whole_leaves(0.03, 0.5);
  const auto strong = static_cast<std::uint16_t>(kFull), weak = static_cast<std::uint16_t>(0.3 * kFull);
  for (int i = 0; i < 20000; ++i) several.add_pair(strong, strong, 0.0125 + 0.005 * (i % 10), 0.07 * (i % 2), true);
  EchoStatistics one = several, weaker = several;
  for (int i = 0; i < 20000; ++i) one.add_same_beam_beside();
  // Weak echoes do not count: these would make leaves of nothing.
  for (int i = 0; i < 20000; ++i) weaker.add_pair(weak, weak, 0.0125 + 0.005 * (i % 10), 0.3, true);
  EchoKnowledge known = lidar(0.03);
  known.leaf_size_m2 = -1, known.full_echo = kFull;
  const auto area_m2 = [&](const EchoStatistics& s) { return estimate_echo_model(s, known)->leaf_size_m2; };
  EXPECT_GT(area_m2(several), 2 * area_m2(one));
  EXPECT_EQ(area_m2(weaker), area_m2(several));
}

TEST(EchoModel, WhatIsKnownIsTaken) {
  EchoKnowledge known = lidar(0.03);
  known.full_echo = 2500, known.beam.detection_share = 0.4;
  const auto model = estimate_echo_model(whole_leaves(0.03, 0.8), known);
  EXPECT_EQ(model->full_echo, 2500);
  EXPECT_EQ(model->full_echo_error, 0);
  EXPECT_EQ(model->detection_share, 0.4);
  EXPECT_EQ(model->leaf_size_m2, 0.0064);
}

// What is lost must not go with the unit in which a lidar tells intensities: where full echoes are 37 to 90 of them,
// the band above the weakest echo holds four to nine whole numbers.
TEST(EchoModel, TheLostShareDoesNotGoWithTheUnitOfIntensities) {
  const auto lost = [](double full) {
    EchoStatistics statistics;
    std::mt19937_64 rng(7);
    std::uniform_real_distribution<double> strength(0.25, 1);
    for (int i = 0; i < 200000; ++i)
      statistics.add_echo(static_cast<std::uint16_t>(std::lround(full * strength(rng))), 0.03);
    for (int i = 0; i < 100000; ++i) statistics.add_same_beam_beside();
    EchoKnowledge known = lidar(0.03);
    known.full_echo = full, known.beam.detection_share = 0.25;
    const auto model = estimate_echo_model(statistics, known);
    EXPECT_GT(model->unreturned_share, 0.7 * model->lost_share);  // 0.83 and more: dark leaves hide more than they lack
    EXPECT_LT(model->unreturned_share, 1.5 * model->lost_share);
    return model->lost_share;
  };
  // Echoes per unit of strength are 1/0.75 of all, their mean strength is 0.625: 1.2·f·t²/2 beside 0.625.
  const double pieces = 1.2 / 0.75 * 0.25 * 0.25 / 2, expected = pieces / (0.625 + pieces);
  for (const double full : {3000.0, 90.0, 64.0, 54.4, 45.0, 37.0})
    EXPECT_NEAR(lost(full), expected, 0.06 * expected) << full;
}

TEST(EchoModel, TooFewEchoesOrNoIntensitiesTellNothing) {
  EXPECT_FALSE(estimate_echo_model(whole_leaves(0.03, 1, 1000), lidar(0.03)).has_value());
  EchoStatistics dark, flat;
  for (int i = 0; i < 20000; ++i) dark.add_echo(0, 0.03), flat.add_echo(255, 0.03);
  EXPECT_FALSE(estimate_echo_model(dark, lidar(0.03)).has_value());
  EXPECT_FALSE(estimate_echo_model(flat, lidar(0.03)).has_value());
}

}  // namespace
}  // namespace rayfield::density
