#include "sim/scan/disturbance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

// Shares of beams, and the mean range of what replaced the echo.
struct Outcome {
  double kept = 0, replaced = 0, nothing = 0, mean_range = 0;
};

Outcome disturb(const Site& site, const std::optional<Echo>& echo) {
  constexpr int kBeams = 40000;
  int kept = 0, replaced = 0;
  double ranges = 0;
  for (std::uint64_t i = 0; i < kBeams; ++i) {
    CounterRandom random(3, Stream::disturbance, i);
    const auto seen = disturbed(site, echo, random);
    if (!seen) continue;
    if (echo && seen->range_m == echo->range_m) {
      ++kept;
    } else {
      ++replaced, ranges += seen->range_m;
    }
  }
  const double beams = kBeams;
  return {kept / beams, replaced / beams, (kBeams - kept - replaced) / beams, ranges / std::max(1, replaced)};
}

constexpr double kError = 5 * 0.5 / 200;  // five standard errors of a share, at most

TEST(Disturbance, NothingChangesWhereNothingIsAskedFor) {
  EXPECT_EQ(disturb(small_site(), Echo{5, 1, 100}).kept, 1);
  EXPECT_EQ(disturb(small_site(), std::nullopt).nothing, 1);
}

// Drops are a Poisson process along the beam: none within r with probability exp(−λr).
TEST(Disturbance, RainShadesWhatLiesFar) {
  Site site = small_site();
  site.disturbance.rain_per_m = 0.02;
  EXPECT_NEAR(disturb(site, Echo{5, 1, 100}).kept, std::exp(-0.1), kError);
  EXPECT_NEAR(disturb(site, Echo{30, 1, 100}).kept, std::exp(-0.6), kError);
  EXPECT_NEAR(disturb(site, std::nullopt).nothing, std::exp(-0.02 * site.lidar.max_range_m), kError);
}

TEST(Disturbance, SpuriousReturnsLieAnywhereAndAreAsFrequentAsStated) {
  Site site = small_site();
  site.disturbance.spurious_share = 0.2;
  const Outcome outcome = disturb(site, Echo{1, 1, 100});
  EXPECT_NEAR(outcome.replaced, 0.2, kError);
  const double mean = 0.5 * (site.lidar.min_range_m + site.lidar.max_range_m);
  EXPECT_NEAR(outcome.mean_range, mean, 5 * mean / std::sqrt(3 * 8000));
}

TEST(Disturbance, DustLiesBeforeTheScene) {
  Site site = small_site();
  site.disturbance.dust_share = 0.1;
  const Outcome outcome = disturb(site, Echo{3, 1, 100});
  EXPECT_GT(outcome.replaced, 0.05);
  EXPECT_LT(outcome.replaced, 0.1 + kError);
  EXPECT_LT(outcome.mean_range, 3);
  EXPECT_NEAR(disturb(site, std::nullopt).replaced, 0.1, kError);
}

TEST(Disturbance, TheWeakestEchoesAreLostMostOften) {
  SiteDisturbance disturbance;
  disturbance.lost_echo_share = 0.4;
  EXPECT_DOUBLE_EQ(chance_of_loss(disturbance, 0.2, 0.2), 0.4);
  EXPECT_DOUBLE_EQ(chance_of_loss(disturbance, 0.3, 0.2), 0.2);
  EXPECT_EQ(chance_of_loss(disturbance, 0.4, 0.2), 0);
  EXPECT_EQ(chance_of_loss(disturbance, 0.9, 0.2), 0);
}

}  // namespace
}  // namespace rayfield::sim
