#include "libdensity/leaf_angles/leaf_angle_fit.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "libdensity/echoes/leaf_angle.h"

namespace rayfield::density {
namespace {

/// Voxels of some density, each seen by rays of a few directions and ranges, met as often as leaves of an ellipsoid's
/// angles and a loss with the range say.
std::vector<DirectionLikelihood> parts_of(double ratio, double loss_per_m, bool wide, int voxels = 1500,
                                          double full_echo = 1) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<DirectionLikelihood> parts(8, DirectionLikelihood(wide ? std::optional(full_echo) : std::nullopt));
  std::array<double, DirectionCounters::kSteepness> projection{};
  for (std::size_t k = 0; k < projection.size(); ++k)
    projection[k] = leaf_projection({LeafAngleType::ellipsoidal, ratio}, DirectionCounters::kSine[k]);
  for (int v = 0; v < voxels; ++v) {
    const double density = 0.2 + 0.8 * uniform(engine);
    DirectionCounters voxel;
    for (std::size_t k = 0; k < DirectionCounters::kSteepness; ++k)
      for (std::size_t d = 0; d < (wide ? DirectionCounters::kRanges : 1); ++d) {
        if (uniform(engine) < 0.4) continue;
        const std::size_t bin = d * DirectionCounters::kSteepness + k;
        const double path = 40 * uniform(engine);
        const double met = path * density * projection[k] * std::exp(-loss_per_m * DirectionCounters::kRange_m[d]);
        voxel.add_path(bin, path);
        voxel.hits[bin] = std::llrint(full_echo) * std::poisson_distribution<long>(met)(engine);
      }
    parts[static_cast<std::size_t>(v) % parts.size()].add(voxel);
  }
  return parts;
}

TEST(DirectionCounters, BinsGoBySteepnessUpAndDownAndByRange) {
  const auto bin_of = [](double sine, double range_m) {
    return DirectionCounters::bin_of(DirectionCounters::steepness_of(sine), range_m);
  };
  EXPECT_EQ(bin_of(0.05, 0), 0U);
  EXPECT_EQ(bin_of(-0.25, 0), 2U);
  EXPECT_EQ(bin_of(0.99, 5.0), DirectionCounters::kBins - 1);
  for (std::size_t k = 0; k < DirectionCounters::kSteepness; ++k)
    for (std::size_t d = 0; d < DirectionCounters::kRanges; ++d)
      EXPECT_EQ(bin_of(DirectionCounters::kSine[k], DirectionCounters::kRange_m[d]),
                d * DirectionCounters::kSteepness + k);
}

// Errors are about those of Poisson hits here: 0.02 to 0.06.
TEST(LeafAngleFit, DirectionsOfHitsTellTheRatioOfTheEllipsoid) {
  for (const double ratio : {0.8, 1.0, 2.0, 3.5}) {
    const LeafAngleFit fit = fit_leaf_angles(parts_of(ratio, 0, false));
    ASSERT_TRUE(fit.measured) << ratio;
    EXPECT_LT(fit.error, 0.15) << ratio;
    EXPECT_NEAR(fit.ln_ratio, std::log(ratio), 3 * fit.error + 0.02) << ratio;
  }
}

TEST(LeafAngleFit, WhatWideBeamsLoseIsNotTakenForAngles) {
  for (const double ratio : {1.0, 3.0}) {
    const std::vector<DirectionLikelihood> parts = parts_of(ratio, 0.25, true, 1500, 105);
    const LeafAngleFit fit = fit_leaf_angles(parts);
    ASSERT_TRUE(fit.measured) << ratio;
    EXPECT_NEAR(fit.ln_ratio, std::log(ratio), 3 * fit.error + 0.02) << ratio;
  }
}

TEST(LeafAngleFit, FewHitsOrFewPartsTellNothing) {
  EXPECT_FALSE(fit_leaf_angles({}).measured);
  EXPECT_FALSE(fit_leaf_angles(parts_of(3, 0, false, 60)).measured);
  const std::vector<DirectionLikelihood> parts = parts_of(3, 0, false);
  EXPECT_FALSE(fit_leaf_angles(std::span(parts).first(3)).measured);
  EXPECT_EQ(LeafAngleFit{}.angles().type, LeafAngleType::spherical);
}

TEST(LeafAngleFit, PartsThatDisagreeTellNothing) {
  std::vector<DirectionLikelihood> parts = parts_of(0.7, 0, false), flat = parts_of(6, 0, false, 9000);
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) parts[i] = parts[7];
  parts[0] = flat[0];
  EXPECT_FALSE(fit_leaf_angles(parts).measured);
}

TEST(LeafAngleFit, LevelRaysMeetFlatLeavesAtASmallCosine) {
  EXPECT_NEAR(fit_leaf_angles(parts_of(1, 0, false)).aspect.mean_cosine, kSphericalMeanCosine, 1e-6);
  EXPECT_LT(fit_leaf_angles(parts_of(3.5, 0, false)).aspect.mean_cosine, kSphericalMeanCosine - 0.05);
  // As the options say, whatever the hits say.
  const LeafAngles upright{LeafAngleType::erectophile, 1};
  EXPECT_GT(fit_leaf_angles(parts_of(3.5, 0, false), upright).aspect.mean_cosine, kSphericalMeanCosine);
  EXPECT_FALSE(fit_leaf_angles(parts_of(3.5, 0, false), upright).measured);
}

// Leaves turned at random look a little steep through wide beams, and sites differ more.
TEST(LeafAngleFit, ThroughWideBeamsSphericalLeavesLookAnotherWay) {
  const LeafAngleFit wide = fit_leaf_angles(parts_of(2.5, 0.25, true, 1500, 105));
  const LeafAngleFit thin = fit_leaf_angles(parts_of(2.5, 0, false));
  EXPECT_EQ(thin.spherical_looks, kSphericalLooks);
  EXPECT_EQ(wide.spherical_looks, kSphericalLooksWide);
  EXPECT_GT(wide.flatter()->value, thin.flatter()->value + 0.2);
  EXPECT_GT(wide.flatter()->error, 1.5 * thin.flatter()->error);
  EXPECT_LT(wide.aspect.apparent_side, 1);
  EXPECT_EQ(fit_leaf_angles(parts_of(0.8, 0, false)).aspect.apparent_side, 1);
}

// Level beams lose more than steep ones, which looks like leaves that lie flat.
TEST(LeafAngleFit, TheMoreIsLostTheLessDirectionsSay) {
  LeafAngleFit fit;
  fit.wide_beams = fit.measured = true, fit.ln_ratio = 1.0 + kSphericalLooksWide,
  fit.spherical_looks = kSphericalLooksWide;
  EXPECT_NEAR(fit.by_directions()->error, 0.25, 1e-9);
  EXPECT_NEAR(std::log(fit.angles().ellipsoid_ratio), 1.0, 1e-9);
  fit.lost_share = 0.1;
  EXPECT_NEAR(fit.by_directions()->error, std::hypot(0.25, 0.4), 1e-9);
  EXPECT_LT(std::log(fit.angles().ellipsoid_ratio), 0.2);
  EXPECT_GT(fit.area_error(), 0.5) << "what is left out of the ratio is in the error";
  fit.wide_beams = false, fit.spherical_looks = kSphericalLooks;
  EXPECT_NEAR(fit.by_directions()->error, 0.15, 1e-9);
  const std::vector<DirectionLikelihood> parts = parts_of(2.5, 0.25, true, 1500, 105);
  EXPECT_EQ(fit_leaf_angles(parts, {LeafAngleType::measured, 1}, std::nullopt, 0.07).lost_share, 0.07);
}

TEST(LeafAngleFit, NormalsOfFullEchoesSayMoreThanDirections) {
  const std::vector<DirectionLikelihood> looks_flat = parts_of(2.0, 0.25, true, 1500, 105);
  const LeafAngleFit spherical = fit_leaf_angles(looks_flat, {LeafAngleType::measured, 1}, LnRatio{0, 0.05});
  EXPECT_EQ(spherical.angles().type, LeafAngleType::spherical);
  const LeafAngleFit flat = fit_leaf_angles(looks_flat, {LeafAngleType::measured, 1}, LnRatio{1.0, 0.05});
  EXPECT_NEAR(std::log(flat.angles().ellipsoid_ratio), 1.0, 0.05);
  EXPECT_LT(flat.flatter()->error, 0.16);
  EXPECT_LT(flat.aspect.mean_cosine, spherical.aspect.mean_cosine);
  // Where directions tell nothing normals do; options go before either.
  const LeafAngleFit alone =
      fit_leaf_angles(std::span(looks_flat).first(3), {LeafAngleType::measured, 1}, LnRatio{1.0, 0.05});
  EXPECT_FALSE(alone.measured);
  EXPECT_NEAR(std::log(alone.angles().ellipsoid_ratio), 1.0, 1e-9);
  EXPECT_FALSE(fit_leaf_angles(looks_flat, {LeafAngleType::uniform, 1}, LnRatio{1.0, 0.05}).flatter());
}

TEST(LeafAngleFit, WhatIsNotKnownOfTheAnglesIsAnErrorOfAreas) {
  const auto error_of = [](double value, double error) {
    LeafAngleFit fit;
    fit.wide_beams = true, fit.normals = LnRatio{value, error};
    return fit.area_error();
  };
  EXPECT_EQ(LeafAngleFit{}.area_error(), 0);
  LeafAngleFit untold;
  untold.wide_beams = true;
  EXPECT_FALSE(untold.tells());
  EXPECT_NEAR(untold.area_error(), 0.6 * 0.7, 1e-9);
  EXPECT_LT(error_of(0.1, 0.4), untold.area_error());
  EXPECT_NEAR(error_of(0.3, 0.3), 0.6 * std::hypot(0.3, 0.38), 1e-6);
  untold.given = true;
  EXPECT_EQ(untold.area_error(), 0);
  EXPECT_EQ(error_of(0.05, 0.1), 0);  // as leaves turned at random look
  EXPECT_EQ(error_of(-0.4, 0.1), 0);
  EXPECT_NEAR(error_of(0.3, 0.1), 0.6 * (0.3 - std::hypot(0.1, 0.15)),
              1e-6);  // taken for such, though they look flatter
  EXPECT_GT(error_of(0.9, 0.4), error_of(0.9, 0.05));
  EXPECT_NEAR(error_of(1.0, 0.05), 0.6 * std::hypot(0.05, 0.15), 1e-6);
}

TEST(LeafAngleFit, DirectionsAndNormalsThatDisagreeLeaveMoreError) {
  LeafAngleFit fit;
  fit.wide_beams = fit.measured = true, fit.ln_ratio = 1.0 + kSphericalLooksWide,
  fit.spherical_looks = kSphericalLooksWide;
  fit.error = 0, fit.normals = LnRatio{1.0, 0};
  EXPECT_EQ(fit.disagreement(), 1);
  const double agreed = fit.area_error();
  EXPECT_NEAR(agreed, 0.6 / std::hypot(1 / 0.15, 1 / 0.25), 1e-9);
  fit.ln_ratio -= 2 * std::hypot(0.15, 0.25);
  EXPECT_NEAR(fit.disagreement(), 2, 1e-9);
  ASSERT_EQ(fit.angles().type, LeafAngleType::ellipsoidal);
  EXPECT_NEAR(fit.area_error(), 2 * agreed, 1e-9);
}

// Rays that go up to 15° up and down: what makes apparent density differ by a few per cent looks like a large ratio.
TEST(LeafAngleFit, LevelRaysHaveToSayMore) {
  std::vector<DirectionLikelihood> level(8, DirectionLikelihood(std::nullopt));
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t v = 0; v < 30000; ++v) {
    DirectionCounters voxel;
    const double density = 0.2 + 0.8 * uniform(engine);
    for (const std::size_t k : {0, 1, 2}) {
      const double path = 40 * uniform(engine);
      const double more = 1 + 0.03 * static_cast<double>(k);  // of apparent density, for whatever reason
      const double met =
          path * density * more * leaf_projection({LeafAngleType::spherical, 1}, DirectionCounters::kSine[k]);
      voxel.add_path(k, path);
      voxel.hits[k] = std::poisson_distribution<long>(met)(engine);
    }
    level[v % level.size()].add(voxel);
  }
  const LeafAngleFit fit = fit_leaf_angles(level), steep = fit_leaf_angles(parts_of(1, 0, false));
  ASSERT_TRUE(fit.measured);
  EXPECT_GT(fit.ln_ratio, 0.5) << "as flat as some leaves are";
  EXPECT_LT(fit.leverage, 0.06);
  EXPECT_EQ(fit.angles().type, LeafAngleType::spherical);
  EXPECT_GT(steep.leverage, kUsualLeverage);
}

TEST(LeafAngleFit, LeavesAreSphericalUnlessTheyAreClearlyFlatter) {
  const auto ratio_of = [](double ln_ratio) {
    const LeafAngles angles = LeafAngleFit{ln_ratio, 0.05, true}.angles();
    return angles.type == LeafAngleType::spherical ? 1.0 : angles.ellipsoid_ratio;
  };
  for (const double ln_ratio : {-1.5, 0.0, 0.2, 0.42}) EXPECT_EQ(ratio_of(ln_ratio), 1) << ln_ratio;
  EXPECT_NEAR(ratio_of(1.3), std::exp(1.3 - 0.12), 1e-9);
  double before = 1;
  for (double ln_ratio = 0.4; ln_ratio < 1.2; ln_ratio += 0.01) {  // no step between
    EXPECT_GE(ratio_of(ln_ratio), before);
    EXPECT_LT(ratio_of(ln_ratio), before + 0.08) << ln_ratio;
    before = ratio_of(ln_ratio);
  }
}

}  // namespace
}  // namespace rayfield::density
