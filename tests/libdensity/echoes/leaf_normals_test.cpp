#include "libdensity/echoes/leaf_normals.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "libdensity/echoes/leaf_angle.h"

namespace rayfield::density {
namespace {

/// A unit vector to all sides alike.
Eigen::Vector3d any_direction(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
}

/// Inclinations of these leaves.
class Inclinations {
 public:
  explicit Inclinations(const LeafAngles& angles) {
    for (std::size_t i = 0; i < kBins; ++i)
      weights_[i] = leaf_inclination_density(angles, (static_cast<double>(i) + 0.5) * kBin);
    bins_ = std::discrete_distribution<std::size_t>(weights_.begin(), weights_.end());
  }
  double operator()(std::mt19937_64& rng) {
    return (static_cast<double>(bins_(rng)) + std::uniform_real_distribution<double>(0, 1)(rng)) * kBin;
  }

 private:
  static constexpr std::size_t kBins = 200;
  static constexpr double kBin = std::numbers::pi / 2 / kBins;
  std::array<double, kBins> weights_{};
  std::discrete_distribution<std::size_t> bins_;
};

/// Normals of leaves of these angles that rays meet which go up to `steepest_rad` up and down; the more a leaf faces
/// the ray, the likelier it makes a full echo. Each leaf makes `of_a_leaf` of them; normals are off by `noise_rad`.
std::vector<FullEcho> normals_of(const LeafAngles& angles, std::size_t count, double steepest_rad = 0.4,
                                 std::size_t of_a_leaf = 1, double noise_rad = 0.12, std::uint64_t seed = 5) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> noise(0, noise_rad);
  Inclinations inclinations(angles);
  std::vector<FullEcho> echoes;
  while (echoes.size() < count) {
    const double inclination = inclinations(rng), azimuth = 2 * std::numbers::pi * uniform(rng);
    Eigen::Vector3d leaf(std::sin(inclination) * std::cos(azimuth), std::sin(inclination) * std::sin(azimuth),
                         std::cos(inclination));
    const double up = std::sin(steepest_rad * (2 * uniform(rng) - 1));
    const Eigen::Vector3d to_lidar(std::sqrt(1 - up * up), 0, up);
    if (leaf.dot(to_lidar) < 0) leaf = -leaf;
    if (std::pow(leaf.dot(to_lidar), 4) < uniform(rng)) continue;
    for (std::size_t k = 0; k < of_a_leaf; ++k) {
      const Eigen::Vector3d turn = any_direction(rng).cross(leaf).normalized() * std::hypot(noise(rng), noise(rng));
      const Eigen::Vector3d seen = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * leaf;
      FullEcho e{100, 0.01F, static_cast<float>(seen.dot(to_lidar))};
      e.ray_up = static_cast<float>(up), e.normal_up = static_cast<float>(seen.z());
      e.normal_variance = static_cast<float>(noise_rad * noise_rad);
      echoes.push_back(e);
    }
  }
  return echoes;
}

/// ln of the ratio of the ellipsoid that shows level rays as much.
double ln_ratio_of(const LeafAngles& angles) {
  double low = -1.5, high = 2.5;
  while (high - low > 1e-3) {
    const double middle = (low + high) / 2;
    const bool flatter =
        leaf_projection({LeafAngleType::ellipsoidal, std::exp(middle)}, 0) > leaf_projection(angles, 0);
    (flatter ? low : high) = middle;
  }
  return (low + high) / 2;
}

// Level rays never meet the leaves that lie flattest: how many there are is beyond what normals tell.
TEST(LeafNormalsFit, TellHowMuchLevelRaysSeeOfLeavesOfAnyShape) {
  for (const LeafAngles& angles : {LeafAngles{LeafAngleType::spherical, 1}, LeafAngles{LeafAngleType::ellipsoidal, 2.0},
                                   LeafAngles{LeafAngleType::ellipsoidal, 3.0},
                                   LeafAngles{LeafAngleType::planophile, 1}, LeafAngles{LeafAngleType::plagiophile, 1},
                                   LeafAngles{LeafAngleType::erectophile, 1}, LeafAngles{LeafAngleType::uniform, 1}})
    for (const auto& [steepest_rad, beyond] : {std::pair(0.25, 0.2), std::pair(0.8, 0.08)}) {
      const auto fit = fit_leaf_normals(normals_of(angles, 1500, steepest_rad));
      ASSERT_TRUE(fit);
      EXPECT_LT(fit->error, 0.2);
      EXPECT_NEAR(fit->value, ln_ratio_of(angles), beyond + 2 * fit->error)
          << static_cast<int>(angles.type) << ' ' << steepest_rad;
    }
}

// Normals at 45° are as frequent as of ellipsoids of ln ratios of 0.6 to 0.9, which show level rays much less.
TEST(LeafNormalsFit, LeavesAslantAreNotTakenForFlatOnes) {
  const LeafAngles aslant{LeafAngleType::plagiophile, 1};
  double sum = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4})
    sum += fit_leaf_normals(normals_of(aslant, 3000, 0.5, 1, 0.12, seed))->value / 4;
  EXPECT_NEAR(sum, ln_ratio_of(aslant), 0.15);
}

TEST(LeafNormalsFit, ErrorsOfNormalsDoNotMakeFlatLeavesLookTurnedAtRandom) {
  const LeafAngles flat{LeafAngleType::ellipsoidal, 2.5};
  for (const double noise_rad : {0.05, 0.1, 0.15, 0.2})
    EXPECT_NEAR(fit_leaf_normals(normals_of(flat, 3000, 0.5, 1, noise_rad))->value, std::log(2.5), 0.15) << noise_rad;
}

TEST(LeafNormalsFit, OfOneLeafCountForOne) {
  const LeafAngles angles{LeafAngleType::ellipsoidal, 2.0};
  const auto apart = fit_leaf_normals(normals_of(angles, 1200)),
             alike = fit_leaf_normals(normals_of(angles, 1200, 0.4, 12));
  EXPECT_GT(alike->error, 1.7 * apart->error);  // a twelfth of the leaves, the belief beside
  double squares = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto fit = fit_leaf_normals(normals_of(angles, 1200, 0.4, 12, 0.12, seed));
    squares += std::pow((fit->value - std::log(2.0)) / fit->error, 2);
  }
  EXPECT_LT(squares / 12, 2);
  EXPECT_GT(squares / 12, 0.2);
}

TEST(LeafNormalsFit, FewTellNothingOrLittle) {
  EXPECT_FALSE(fit_leaf_normals({}));
  EXPECT_FALSE(fit_leaf_normals(normals_of({LeafAngleType::planophile, 1}, 9)));
  const auto few = fit_leaf_normals(normals_of({LeafAngleType::spherical, 1}, 12));
  ASSERT_TRUE(few);
  EXPECT_GT(few->error, 0.25);
}

TEST(LeafNormalsFit, ManyAreLookedAtEvenly) {
  const auto many = fit_leaf_normals(normals_of({LeafAngleType::ellipsoidal, 2.0}, 25000, 0.4));
  EXPECT_NEAR(many->value, std::log(2.0), 0.1);
}

}  // namespace
}  // namespace rayfield::density
