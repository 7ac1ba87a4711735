#include "libdensity/echoes/leaf_angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace rayfield::density {
namespace {

constexpr double kPi = std::numbers::pi;

std::string_view name_of(LeafAngleType type) {
  for (const auto& [name, named] : kLeafAngleTypes)
    if (named == type) return name;
  return "unknown";
}

std::vector<LeafAngles> all_types() {
  std::vector<LeafAngles> out;
  for (const auto type : {LeafAngleType::spherical, LeafAngleType::uniform, LeafAngleType::planophile,
                          LeafAngleType::erectophile, LeafAngleType::plagiophile, LeafAngleType::extremophile})
    out.push_back({type, 1.0});
  for (const double ratio : {0.3, 1.0, 3.0}) out.push_back({LeafAngleType::ellipsoidal, ratio});
  return out;
}

TEST(LeafAngles, ADensityOfInclinationsIntegratesToOne) {
  for (const LeafAngles& angles : all_types()) {
    double sum = 0;
    for (int i = 0; i < 2000; ++i) sum += leaf_inclination_density(angles, (i + 0.5) * kPi / 4000) * kPi / 4000;
    EXPECT_NEAR(sum, 1.0, 1e-4) << name_of(angles.type) << " " << angles.ellipsoid_ratio;
  }
}

TEST(LeafAngles, SphericalLeavesShowHalfTheirAreaToEveryRay) {
  for (const double c : {0.0, 0.3, -0.7, 1.0}) EXPECT_DOUBLE_EQ(leaf_projection({}, c), 0.5);
}

TEST(LeafAngles, AVerticalRaySeesTheMeanCosineOfTheInclination) {
  // ∫ cos θ f(θ) dθ of de Wit's densities.
  EXPECT_NEAR(leaf_projection({LeafAngleType::planophile, 1}, 1), 8 / (3 * kPi), 1e-4);
  EXPECT_NEAR(leaf_projection({LeafAngleType::erectophile, 1}, 1), 4 / (3 * kPi), 1e-4);
  EXPECT_NEAR(leaf_projection({LeafAngleType::uniform, 1}, 1), 2 / kPi, 1e-4);
}

TEST(LeafAngles, AllDirectionsTogetherSeeHalfTheAreaWhateverTheLeaves) {
  // Cauchy: the mean projection of a flat piece over the sphere is half its one-sided area.
  for (const LeafAngles& angles : all_types()) {
    double sum = 0;
    for (int i = 0; i < 400; ++i) sum += leaf_projection(angles, (i + 0.5) / 400) / 400;
    EXPECT_NEAR(sum, 0.5, 5e-4) << name_of(angles.type) << " " << angles.ellipsoid_ratio;
  }
}

TEST(LeafAngles, AnEllipsoidOfRatioOneIsASphere) {
  for (const double c : {0.0, 0.5, 1.0}) EXPECT_NEAR(leaf_projection({LeafAngleType::ellipsoidal, 1.0}, c), 0.5, 1e-4);
}

TEST(LeafAngles, FlatEllipsoidsShowMoreToVerticalRaysAsTheirGeometrySays) {
  // Campbell 1986: K(θ)·cos θ with K = √(χ² + tan²θ)/Λ', for θ = 0 and χ = 3 by the exact area of the spheroid:
  // G(0) = projected disc π·a² over half the surface, with a = χ·b (oblate).
  const double chi = 3, e = std::sqrt(1 - 1 / (chi * chi));
  const double surface = 2 * kPi * chi * chi + kPi * std::log((1 + e) / (1 - e)) / e;  // b = 1
  EXPECT_NEAR(leaf_projection({LeafAngleType::ellipsoidal, chi}, 1), kPi * chi * chi / (surface / 2), 2e-3);
}

TEST(LeafAngles, TheMeanCosineOfHitsIsTwoThirdsForLeavesTurnedAtRandom) {
  for (const double c : {0.0, 0.3, -0.7, 1.0}) EXPECT_NEAR(mean_incidence_cosine({}, c), kSphericalMeanCosine, 1e-5);
}

TEST(LeafAngles, AVerticalRayMeetsLeavesAtTheirInclination) {
  // ∫ cos²θ f(θ) dθ over ∫ cos θ f(θ) dθ of de Wit's densities: ¾ over 8/(3π), and ¼ over 4/(3π).
  EXPECT_NEAR(mean_incidence_cosine({LeafAngleType::planophile, 1}, 1), 0.75 * 3 * kPi / 8, 1e-4);
  EXPECT_NEAR(mean_incidence_cosine({LeafAngleType::erectophile, 1}, 1), 0.25 * 3 * kPi / 4, 1e-4);
  // A level ray: half the mean square of the sine, over G.
  const LeafAngles flat{LeafAngleType::planophile, 1};
  EXPECT_NEAR(mean_incidence_cosine(flat, 0), 0.25 / 2 / leaf_projection(flat, 0), 1e-4);
}

TEST(LeafAngles, TheTableAgreesWithTheIntegral) {
  for (const LeafAngles& angles : all_types()) {
    const LeafProjectionTable table(angles);
    for (double c = -1; c <= 1.0001; c += 0.0371) EXPECT_NEAR(table(c), leaf_projection(angles, c), 5e-4);
  }
}

}  // namespace
}  // namespace rayfield::density
