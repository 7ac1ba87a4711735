#include "rayfield/core/beam_spot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace rayfield {
namespace {

// Ground 1.8 m below a lidar with beams of 13.6 mm + 11.9 mrad, 1 to 10 m away, as a lidar of this resolution sees it.
std::vector<SpotLift> lifts_with(double resolution_m, double noise_m) {
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0, noise_m);
  std::uniform_real_distribution<double> away(1, 10);
  std::vector<SpotLift> lifts;
  for (int i = 0; i < 4000; ++i) {
    const double range_m = std::hypot(1.8, away(generator)), cosine = 1.8 / range_m;
    const double depth_m = (0.0136 + 0.0119 * range_m) * std::tan(std::acos(cosine));
    lifts.push_back({depth_m, cosine, cosine * spot_shift_m(depth_m, resolution_m) + noise(generator)});
  }
  return lifts;
}

TEST(SpotShift, IsThatOfThePartOfTheDiscWithinTheResolution) {
  EXPECT_EQ(spot_shift_m(0.2, 0.2), 0);
  EXPECT_EQ(spot_shift_m(0.2, 0.5), 0);
  EXPECT_NEAR(spot_shift_m(0.2, 1e-6), 0.1, 1e-5);                               // the near edge alone
  EXPECT_NEAR(spot_shift_m(0.2, 0.1), 0.1 * 4 / (3 * std::numbers::pi), 1e-12);  // the centroid of half a disc
  for (double b = 0.01; b < 0.2; b += 0.01) EXPECT_GT(spot_shift_m(0.2, b), spot_shift_m(0.2, b + 0.01));
}

TEST(FitRangeResolution, FindsWhatThePlaneWasSeenWith) {
  for (const double truth : {0.06, 0.15, 0.25, 0.4}) {
    const RangeResolution found = fit_range_resolution(lifts_with(truth, 0.002));
    EXPECT_NEAR(found.value_m, truth, 0.04 * truth);  // steps of 3 %
    EXPECT_LT(found.sigma_m, 0.05 * truth);
    EXPECT_EQ(found.pairs, 4000U);
  }
}

TEST(FitRangeResolution, IsBelievedWhereSectionsAgreeAndEchoesCameEarly) {
  const RangeResolution found = fit_range_resolution(lifts_with(0.15, 0.002));
  ASSERT_TRUE(believed(found, 0.01, 0.5));
  EXPECT_EQ(believed(found, 0.01, 0.5)->value_m, found.value_m - 0.01);
  EXPECT_EQ(believed(found, 1, 0.5)->value_m, 0.005);  // no lidar's is finer
  EXPECT_FALSE(believed({0.15, 0.08, 400}, 0.01, 0.5));
  EXPECT_TRUE(believed({0.15, 0.08, 400}, 0.01, 1));
  EXPECT_FALSE(believed({kMaxRangeResolution_m, 0, 400}, 0.01, 1));
}

}  // namespace
}  // namespace rayfield
