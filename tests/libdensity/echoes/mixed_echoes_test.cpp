#include "libdensity/echoes/mixed_echoes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace rayfield::density {
namespace {

constexpr double kWidthM = 0.03;
// From one beam to the next, across and up, so that beside one on an edge they are whole.
constexpr double kStepM = 0.016;

/// Level beams northwards over the edges of leaves 12 cm wide, each with other leaves up to 40 cm behind what is seen
/// beside it. Beams that meet the edge see both leaves where these are within the range resolution, at their mean
/// range; else the front one, where they fall on it with half or more, or the one behind.
std::vector<LeafEcho> edges(double range_resolution_m, double noise_m, std::uint64_t seed, int leaves = 400) {
  std::vector<LeafEcho> echoes;
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> gap_of(0.03, 0.5), shift_of(0, kStepM);
  std::normal_distribution<double> noise(0, noise_m);
  for (int leaf = 0; leaf < leaves; ++leaf) {
    const double gap = gap_of(rng), shift = shift_of(rng);
    for (int i = -5; i <= 5; ++i)
      for (int k = 0; k < 3; ++k) {
        const double x = i * kStepM + shift;
        const double behind = std::clamp(0.5 + x / kWidthM, 0.0, 1.0);  // share of the beam past the edge at x = 0
        double y = behind > 0.5 ? gap : 0;
        if (gap <= range_resolution_m) y = behind * gap;
        echoes.push_back({Eigen::Vector3d(x, y + noise(rng) + 1e-4, leaf * 0.5 + k * kStepM).cast<float>(),
                          Eigen::Vector3f::UnitY(), static_cast<float>(kWidthM), 100});
      }
  }
  return echoes;
}

MixedEchoes mixed_of(const std::vector<LeafEcho>& echoes) { return find_mixed_echoes(EchoColumns(echoes), 15000); }

std::int64_t total(const MixedEchoes& mixed, std::int64_t MixedEchoes::Count::*what) {
  std::int64_t sum = 0;
  for (const MixedEchoes::Count& count : mixed.gaps) sum += count.*what;
  return sum;
}

TEST(MixedEchoes, LieBetweenTheirNeighboursWithinTheRangeResolutionOnly) {
  const MixedEchoes mixed = mixed_of(edges(0.2, 0.002, 1));
  std::int64_t within = 0, between_within = 0, beyond = 0, between_beyond = 0;
  for (int gap = 6; gap < 50; ++gap) {
    const MixedEchoes::Count& count = mixed.gaps[static_cast<std::size_t>(gap)];
    (gap < 18 ? within : beyond) += count.all;
    (gap < 18 ? between_within : between_beyond) += gap < 18 || gap > 22 ? count.between : 0;
  }
  ASSERT_GT(within, 300);
  ASSERT_GT(beyond, 300);
  EXPECT_GT(static_cast<double>(between_within), 0.4 * static_cast<double>(within));
  EXPECT_LT(static_cast<double>(between_beyond), 0.02 * static_cast<double>(beyond));
}

// What is taken off for canopies, 22 mm, is not missing here. Ranges with 2 cm of noise make fine resolutions look
// coarser.
TEST(MixedEchoes, TellTheRangeResolution) {
  for (const double resolution_m : {0.10, 0.16, 0.24, 0.32})
    for (const double noise_m : {0.0, 0.01, 0.02}) {
      if (noise_m > 0.1 * resolution_m) continue;
      const BelievedResolution found = range_resolution_of(mixed_of(edges(resolution_m, noise_m, 2)));
      EXPECT_NEAR(found.value_m + 0.022, resolution_m, 0.02) << noise_m;
      EXPECT_LT(found.error_m, 0.015) << resolution_m << ", " << noise_m;
    }
}

// What is left is what is usual, or what is usual of those that the few do not contradict.
TEST(MixedEchoes, TooFewLeaveWhatIsUsual) {
  const BelievedResolution usual = range_resolution_of({});
  EXPECT_NEAR(usual.value_m, 0.17 * std::exp(-0.4 * 0.4), 0.005);  // the mode
  EXPECT_NEAR(usual.error_m, 0.08, 0.01);
  const BelievedResolution few = range_resolution_of(mixed_of(edges(0.32, 0.01, 3, 8)));
  EXPECT_GT(few.value_m, usual.value_m + 0.02);
  EXPECT_GT(few.error_m, 0.03);
}

// Where echoes lie between others at any gap nothing falls.
TEST(MixedEchoes, CoarserResolutionsThanLeavesAreDeepAreTakenForTheCoarsest) {
  EXPECT_GT(range_resolution_of(mixed_of(edges(1, 0.01, 4))).value_m, 0.38);
}

/// A level beam northwards.
LeafEcho echo(float x, float y, float z = 0) {
  return {Eigen::Vector3f(x, y, z), Eigen::Vector3f::UnitY(), static_cast<float>(kWidthM), 100};
}

TEST(MixedEchoes, NeedANearerAndAFartherNeighbourOnEitherSideFromTheSameDirection) {
  const std::vector<LeafEcho> echoes = {echo(-0.02F, 0), echo(0, 0.105F), echo(0.02F, 0.205F)};
  const MixedEchoes mixed = mixed_of(echoes);
  EXPECT_EQ(mixed.gaps[20], (MixedEchoes::Count{1, 1}));
  EXPECT_EQ(total(mixed, &MixedEchoes::Count::all), 1);
  EXPECT_EQ(mixed_of({echoes[0], echo(0, 0.02F), echoes[2]}).gaps[20], (MixedEchoes::Count{1, 0}));
  for (const LeafEcho& other : {echo(-0.02F, 0.205F, 0.01F), echo(0.035F, 0.205F), echo(0.02F, 0.705F)})
    EXPECT_EQ(total(mixed_of({echoes[0], echoes[1], other}), &MixedEchoes::Count::all), 0);
  LeafEcho turned = echoes[2];
  turned.direction = Eigen::Vector3f(0.08F, 1, 0).normalized();  // 4.6°
  EXPECT_EQ(total(mixed_of({echoes[0], echoes[1], turned}), &MixedEchoes::Count::all), 0);
}

TEST(MixedEchoes, AreTheSameInAnyOrderAndAddUp) {
  std::vector<LeafEcho> echoes = edges(0.2, 0.01, 6);
  const MixedEchoes mixed = mixed_of(echoes);
  std::shuffle(echoes.begin(), echoes.end(), std::mt19937_64(7));
  EXPECT_EQ(mixed_of(echoes), mixed);
  MixedEchoes sum = mixed;
  sum += mixed;
  EXPECT_EQ(total(sum, &MixedEchoes::Count::all), 2 * total(mixed, &MixedEchoes::Count::all));
  EXPECT_EQ(total(sum, &MixedEchoes::Count::between), 2 * total(mixed, &MixedEchoes::Count::between));
}

}  // namespace
}  // namespace rayfield::density
