#include "libdensity/echoes/full_echoes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace rayfield::density {
namespace {

constexpr double kWidthM = 0.03;

/// What level beams northwards, one to every `step_m` across and up, find of a leaf of `side_m` at the origin whose
/// normal is turned by `angle_rad` from them about the vertical; ranges with 8 mm of noise. An echo's intensity tells
/// how far it lies off the middle of the leaf, in its plane and mm.
std::vector<LeafEcho> leaf(double side_m, double angle_rad, std::uint64_t seed, double step_m = 0.009) {
  std::vector<LeafEcho> echoes;
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> noise(0, 0.008);
  const int n = static_cast<int>(side_m / step_m);
  for (int i = -n; i <= n; ++i)
    for (int k = -n; k <= n; ++k) {
      const double x = i * step_m, z = k * step_m, in_plane = x / std::cos(angle_rad);
      if (std::max(std::abs(in_plane), std::abs(z)) > side_m / 2) continue;
      const double y = x * std::tan(angle_rad) + noise(rng);
      const double off_mm = 1000 * std::max(std::abs(x), std::abs(z));
      echoes.push_back({Eigen::Vector3d(x, y, z).cast<float>(), Eigen::Vector3f::UnitY(), static_cast<float>(kWidthM),
                        static_cast<std::uint16_t>(off_mm)});
    }
  return echoes;
}

std::vector<FullEcho> full_of(const std::vector<LeafEcho>& echoes) { return find_full_echoes(EchoColumns(echoes)); }

TEST(FullEchoes, AreInsideALeaf) {
  const std::vector<FullEcho> full = full_of(leaf(0.10, 0, 1));
  EXPECT_GT(full.size(), 10u);
  // Round a full one the leaf goes on for the ring's inner edge, in each sector of 60°.
  for (const FullEcho& e : full) EXPECT_LT(e.intensity, 50 - 1000 * 0.8 * kWidthM * std::cos(std::numbers::pi / 6) + 1);
  for (const FullEcho& e : full) EXPECT_GT(e.cosine, 0.85F);
}

TEST(FullEchoes, TellTheAngleOfTheLeaf) {
  double sum = 0, first = 0, second = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const FullEcho& e : full_of(leaf(0.12, 0.7, seed)))
      sum += static_cast<double>(e.cosine), first += static_cast<double>(e.half_cosine[0][0]),
          second += static_cast<double>(e.half_cosine[0][1]), ++count;
  ASSERT_GT(count, 100);
  EXPECT_NEAR(sum / count, std::cos(0.7), 0.03);
  EXPECT_NEAR(first / count, std::cos(0.7), 0.05);
  EXPECT_NEAR(second / count, std::cos(0.7), 0.05);
}

// Level beams on leaves turned about the vertical, and the same turned on its side: about a level axis.
TEST(FullEchoes, TellWhichWayTheNormalPoints) {
  double upright = 0, tilted = 0, variance = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<LeafEcho> echoes = leaf(0.12, 0.7, seed);
    for (const FullEcho& e : full_of(echoes)) upright += static_cast<double>(e.normal_up);
    for (LeafEcho& e : echoes) std::swap(e.position.x(), e.position.z());
    for (const FullEcho& e : full_of(echoes)) {
      tilted += static_cast<double>(e.normal_up), variance += static_cast<double>(e.normal_variance), ++count;
      EXPECT_EQ(e.ray_up, 0);
    }
  }
  ASSERT_GT(count, 100);
  EXPECT_NEAR(upright / count, 0, 0.04);
  EXPECT_NEAR(tilted / count, std::sin(0.7), 0.06);
  EXPECT_NEAR(std::sqrt(variance / count), 0.1, 0.07);
}

TEST(FullEchoes, AreNotOnLeavesAsSmallAsTheBeamNorOnCanes) {
  EXPECT_TRUE(full_of(leaf(0.035, 0, 2)).empty());
  std::vector<LeafEcho> cane = leaf(0.3, 0, 3);
  std::erase_if(cane, [](const LeafEcho& e) { return std::abs(e.position.x()) > 0.012F; });
  EXPECT_GT(cane.size(), 60u);
  EXPECT_TRUE(full_of(cane).empty());
}

TEST(FullEchoes, AreNotWhereABeamBesideEndedElsewhere) {
  std::vector<LeafEcho> echoes = leaf(0.10, 0, 4);
  for (const LeafEcho& e : leaf(0.10, 0, 5)) {  // every second beam finds a leaf 8 cm behind
    echoes.push_back(e);
    echoes.back().position.y() += 0.08F;
    echoes.back().position.x() += 0.004F;
  }
  EXPECT_TRUE(full_of(echoes).empty());
}

TEST(FullEchoes, OfOtherDirectionsAreNotNeighbours) {
  std::vector<LeafEcho> echoes = leaf(0.10, 0, 6);
  for (LeafEcho& e : echoes)
    if (e.intensity > 0) e.direction = Eigen::Vector3f::UnitX();  // all but the middle one, along the leaf
  EXPECT_TRUE(full_of(echoes).empty());
}

TEST(FullEchoes, AreTheSameInAnyOrder) {
  std::vector<LeafEcho> echoes = leaf(0.12, 0.4, 7);
  const std::vector<FullEcho> full = full_of(echoes);
  std::shuffle(echoes.begin(), echoes.end(), std::mt19937_64(8));
  EXPECT_FALSE(full.empty());
  EXPECT_EQ(full_of(echoes), full);
}

TEST(FullEchoes, AreLookedForAllOverThePlaceUntilEnoughAreFound) {
  std::vector<LeafEcho> echoes;
  for (int i = 0; i < 20; ++i)
    for (LeafEcho e : leaf(0.10, 0, 20 + static_cast<std::uint64_t>(i))) {
      e.position.x() += 0.5F * static_cast<float>(i), e.intensity = static_cast<std::uint16_t>(i);
      echoes.push_back(e);
    }
  const EchoColumns columns(echoes);
  const std::vector<FullEcho> all = find_full_echoes(columns);
  const std::size_t enough = all.size() / 4;
  const std::vector<FullEcho> some = find_full_echoes(columns, enough);
  EXPECT_GE(some.size(), enough);
  EXPECT_LT(some.size(), all.size() / 2);
  EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin()));
  std::array<int, 20> of_leaf{};
  for (const FullEcho& e : some) ++of_leaf[e.intensity];
  EXPECT_GE(std::count_if(of_leaf.begin(), of_leaf.end(), [](int n) { return n > 0; }), 19);
}

/// Full echoes of leaves that face the lidar more or less, `dark` of 1 at angles of 90°; angles are known to 0.15.
std::vector<FullEcho> full_echoes(double dark, double scatter, std::size_t count) {
  std::vector<FullEcho> echoes;
  std::mt19937_64 rng(9);
  std::uniform_real_distribution<double> angle(0, 1);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = angle(rng);
    const auto seen = [&] { return static_cast<float>(std::cos(a + 0.15 * normal(rng))); };
    const double strength = (1 - dark * (1 - std::cos(a))) * (1 + scatter * normal(rng));
    echoes.push_back(
        {static_cast<std::uint16_t>(std::lround(1000 * std::max(0.0, strength))), 0.01F, seen(), seen(), seen()});
  }
  return echoes;
}

TEST(FullEchoStrength, IsThatOfRaysThatMeetLeavesOfAllOrientations) {
  const AngleDependence unknown{0.35, 5};  // the echoes alone
  for (const double dark : {0.0, 0.4, 0.8}) {
    const FullEchoStrength s = full_echo_strength(full_echoes(dark, 0.05, 4000), unknown);
    EXPECT_NEAR(s.intensity, 1000 * (1 - dark / 3), 15) << dark;
    EXPECT_NEAR(s.slope, dark / (1 - dark * 0.18), 0.12) << dark;
    EXPECT_NEAR(s.angle_dependence, dark, 0.08) << dark;
    EXPECT_LT(s.error, 0.02);
  }
}

TEST(FullEchoStrength, TellsTheScatterBesideTheAngle) {
  const AngleDependence unknown{0.35, 5};
  for (const double scatter : {0.05, 0.15, 0.3})
    EXPECT_NEAR(full_echo_strength(full_echoes(0, scatter, 4000), unknown).scatter, scatter, 0.01) << scatter;
  // Angles are known to 0.15, which leaves 0.04 of a dependence of 0.4 unexplained.
  EXPECT_NEAR(full_echo_strength(full_echoes(0.4, 0.15, 4000), unknown).scatter, std::hypot(0.15, 0.04), 0.02);
}

TEST(FullEchoStrength, WhereEchoesScatterTheBeliefCounts) {
  const FullEchoStrength s = full_echo_strength(full_echoes(0, 0.4, 80), {0.3, 0.05});
  EXPECT_NEAR(s.slope, 0.3, 0.05);
  EXPECT_GT(s.error, 0.04);
}

TEST(FullEchoStrength, WhereTheyAreFewTheBeliefAboutTheAngleStands) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{9}}) {
    const FullEchoStrength s = full_echo_strength(full_echoes(0.8, 0.01, count), {0.3, 0.2});
    EXPECT_EQ(s.slope, 0.3);
    EXPECT_EQ(s.slope_error, 0.2);
  }
  EXPECT_LT(full_echo_strength(full_echoes(0.8, 0.01, 4000), {0.3, 0.2}).slope_error, 0.1);
}

// Of a fifth of the full echoes three tenths are missing. What scatters intensities must not move the level then: a
// median would be 1000 without scatter and 932 with it.
TEST(FullEchoStrength, DoesNotDependOnWhatScattersIntensities) {
  std::array<double, 2> levels{};
  for (const bool scattered : {false, true}) {
    std::vector<FullEcho> echoes = full_echoes(0, scattered ? 0.3 : 0, 20000);
    for (std::size_t i = 0; i < echoes.size(); i += 5)
      echoes[i].intensity = static_cast<std::uint16_t>(echoes[i].intensity * 7 / 10);
    levels.at(scattered ? 1 : 0) = full_echo_strength(echoes, {0, 0.001}).intensity;
  }
  EXPECT_NEAR(levels[0], 940, 2);
  EXPECT_NEAR(levels[1], levels[0], 6);
}

TEST(FullEchoStrength, ASingleMirrorCountsLittle) {
  std::vector<FullEcho> echoes = full_echoes(0, 0.05, 500);
  const double without = full_echo_strength(echoes, {0, 0.001}).intensity;
  echoes[0].intensity = 60000;
  EXPECT_NEAR(full_echo_strength(echoes, {0, 0.001}).intensity, without, 3);
}

TEST(FullEchoStrength, IsOfTheFlattest) {
  std::vector<FullEcho> echoes = full_echoes(0, 0.05, 500);
  for (FullEcho e : full_echoes(0, 0.05, 1500)) {  // bundles of canes
    e.intensity /= 3, e.spread_m = 0.017F;
    echoes.push_back(e);
  }
  const FullEchoStrength s = full_echo_strength(echoes, {0, 0.05});
  EXPECT_EQ(s.count, 500u);
  EXPECT_NEAR(s.intensity, 1000, 15);
}

TEST(FullEchoStrength, OfNothingIsNothing) {
  EXPECT_EQ(full_echo_strength({}, {}).intensity, 0);
  const FullEchoStrength one = full_echo_strength(full_echoes(0, 0, 1), {});
  EXPECT_NEAR(one.intensity, 1000, 150);
}

}  // namespace
}  // namespace rayfield::density
