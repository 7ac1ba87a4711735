#include "libdensity/echoes/leaf_size.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "libdensity/voxels/voxel_accumulator.h"
#include "tests/libdensity/hedge_scene.h"

namespace rayfield::density {
namespace {

using testing::Hedge;
using testing::HedgeOptions;

LeafSizePairs pairs_of(const Hedge& hedge, double range_noise_m = 0.012) {
  const auto rays = hedge.scan({.range_noise_m = range_noise_m});
  LeafSizePairs out;
  VoxelOptions count_all;
  count_all.sure_return_m = 0;  // no ray of these scans is missing
  for (int iy = -1; iy <= 0; ++iy)
    for (int ix = -1; ix <= 0; ++ix) {
      auto accumulator = VoxelAccumulator::create({{ix, iy}, 1000}, hedge.row_segments(0.12, 0.72, 2.4), {}, count_all);
      if (!accumulator || !accumulator->add(rays)) return {};
      out += std::move(*accumulator).finish().pairs;
    }
  return out;
}

TEST(LeafSize, LeavesAreMeasuredWithinFifteenPercentFromThirtyFiveToAHundredSquareCentimetres) {
  for (const double area : {0.0035, 0.0065, 0.0100})
    for (const double per_metre : {1.5, 5.0}) {
      HedgeOptions options;
      options.leaf_size_m2 = area, options.leaf_area_per_m = per_metre;
      const LeafSize size = estimate_leaf_size(pairs_of(Hedge(options)));
      EXPECT_TRUE(size.measured);
      EXPECT_NEAR(size.area_m2, area, 0.15 * area) << per_metre << " m²/m";
    }
}

TEST(LeafSize, LeavesOnShootsLookAtMostAThirdLarger) {
  HedgeOptions options;
  options.shoots = true, options.leaf_size_m2 = 0.0065;
  const double area = estimate_leaf_size(pairs_of(Hedge(options))).area_m2;
  EXPECT_GT(area, 0.0065 * 0.9);
  EXPECT_LT(area, 0.0065 * 1.33);
}

TEST(LeafSize, BeamsAloneGiveThePairsOfAFullCount) {
  HedgeOptions options;
  options.post_every_m = 3;
  const Hedge hedge(options);
  const auto rays = hedge.scan({});
  const auto posts = hedge.posts();
  auto full = VoxelAccumulator::create({{0, -1}, 1000}, hedge.row_segments(0.08, 0.72, 2.4), posts, {});
  ASSERT_TRUE(full.has_value());
  VoxelAccumulator beams = *full;
  ASSERT_TRUE(full->add(rays).has_value());
  beams.add_pairs(rays);
  const TileVoxels counted = std::move(*full).finish(), alone = std::move(beams).finish();
  std::uint64_t pairs = 0, difference = 0;
  for (std::size_t i = 0; i < LeafSizePairs::kBins; ++i) {
    const PairCounts whole = counts_of(counted.pairs, 0.05), of_beams = counts_of(alone.pairs, 0.05);
    pairs += whole.near[i];
    for (const auto part : {&PairCounts::near, &PairCounts::front, &PairCounts::same, &PairCounts::behind}) {
      const std::uint64_t a = (whole.*part)[i], b = (of_beams.*part)[i];
      difference += a > b ? a - b : b - a;
    }
  }
  EXPECT_GT(pairs, 5000u);
  EXPECT_LE(difference, pairs / 10000) << "hits on the very face of a voxel may fall on either side";
  for (const RowSegmentVoxels& s : alone.row_segments)
    for (const VoxelCounters& v : s.voxels) ASSERT_EQ(v.rays, 0u);
}

TEST(LeafSize, TooFewPairsGiveTheDefaultAndSaySo) {
  const LeafSize size = estimate_leaf_size(LeafSizePairs{});
  EXPECT_FALSE(size.measured);
  EXPECT_EQ(size.area_m2, LeafSize::kDefaultAreaM2);
}

TEST(LeafSize, ParallelRaysShareALeafLessTheFurtherApartTheyAre) {
  // Face-on squares of side l: E[(1−|Δu|/l)(1−|Δv|/l)] over the turn = 1 − 4r/(πl) + r²/(πl²). Tilted ones are shorter.
  const double l = 0.08;
  double last = 1;
  for (const double r : {0.005, 0.01, 0.02, 0.04, 0.08}) {
    const double p = same_leaf_probability(r, l, {0.05, 0.001});
    EXPECT_LT(p, last);
    EXPECT_LT(p, 1 - 4 * r / (3.14159265 * l) + r * r / (3.14159265 * l * l) + 0.01);
    last = p;
  }
  EXPECT_GT(same_leaf_probability(0.001, l, {0.05, 0.001}), 0.95);
}

TEST(LeafSize, PairsAreSortedByWhereTheNextRayEnds) {
  LeafSizePairs pairs;
  pairs.add(0.012, -0.2, true);   // ended long before: never came near
  pairs.add(0.012, -0.07, true);  // in front
  pairs.add(0.012, 0.01, true);   // at the same depth
  pairs.add(0.012, 0.06, true);   // behind
  pairs.add(0.012, 0.30, true);   // beyond
  pairs.add(0.012, 5.0, false);   // went on
  pairs.add(0.012, 0.05, false);  // cut off: nothing is known
  pairs.add(0.20, 0.0, true);     // too far apart
  const PairCounts narrow = counts_of(pairs, 0.05);
  EXPECT_EQ(narrow.near[2], 5u);
  EXPECT_EQ(narrow.front[2], 1u);
  EXPECT_EQ(narrow.same[2], 1u);
  EXPECT_EQ(narrow.behind[2], 1u);
  const PairCounts wide = counts_of(pairs, 0.10);
  EXPECT_EQ(wide.near[2], 6u);  // it ends 20 cm in front, where wide windows begin
  EXPECT_EQ(wide.front[2], 1u);
  EXPECT_EQ(wide.same[2], 3u);
  EXPECT_EQ(wide.behind[2], 0u);
}

// Of 400 rays within 4 cm of a hit 100 end nearer than 5 cm behind it, 60 in the 10 cm from there on, and the rest
// farther on.
TEST(LeafSize, PairsTellHowDenseLeavesStandBehindLeaves) {
  LeafSizePairs pairs;
  EXPECT_EQ(ends_per_metre_behind(pairs), 2.5);
  for (int i = 0; i < 400; ++i)
    pairs.add(0.015, i < 100 ? 0.02 : i < 160 ? 0.055 + 0.09 * (i - 100) / 60 : 0.3, i % 2 == 0 || i < 160);
  EXPECT_NEAR(ends_per_metre_behind(pairs), 60.0 / 300 / 0.1, 1e-9);
  for (int i = 0; i < 1000; ++i) pairs.add(0.045, 0.1, true);  // too far aside
  EXPECT_NEAR(ends_per_metre_behind(pairs), 60.0 / 300 / 0.1, 1e-9);
}

TEST(LeafSize, NoiseOfRangesIsFoundAndMakesLeavesNoSmaller) {
  HedgeOptions options;
  options.leaf_size_m2 = 0.0100, options.leaf_area_per_m = 3;
  const Hedge hedge(options);
  for (const double noise_m : {0.012, 0.02, 0.025}) {
    const LeafSizePairs pairs = pairs_of(hedge, noise_m);
    EXPECT_NEAR(range_noise_of(pairs), noise_m, 0.003);
    EXPECT_NEAR(estimate_leaf_size(pairs).area_m2, 0.0100, 0.002) << noise_m;
  }
  EXPECT_EQ(range_noise_of({}), 0) << "no pairs";
}

/// A square leaf through a random point of the voxel [0, v)³, and one of the lines that cross the voxel: how often a
/// line of that direction hits the leaf, the chord of the voxel, and what the leaf takes of it.
struct Shadow {
  double weight = 0, chord = 0, in_front = 0, inside = 0;
};

Shadow random_shadow(double side, double v, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized(); };
  const Eigen::Vector3d hit = v * Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng)), n = direction();
  const Eigen::Vector3d a = n.cross(direction()).normalized(), b = n.cross(a);
  const Eigen::Vector3d centre = hit + side * ((uniform(rng) - 0.5) * a + (uniform(rng) - 0.5) * b);
  const Eigen::Vector3d d = direction(), e = d.unitOrthogonal();
  const double disc = 1.8 * v;  // a square across the ray that hides the voxel
  const Eigen::Vector3d o =
      Eigen::Vector3d::Constant(v / 2) + disc * (uniform(rng) - 0.5) * e + disc * (uniform(rng) - 0.5) * d.cross(e);
  double in = -1e9, out = 1e9;
  for (int k = 0; k < 3; ++k) {
    const double f = -o[k] / d[k], g = (v - o[k]) / d[k];
    in = std::max(in, std::min(f, g)), out = std::min(out, std::max(f, g));
  }
  Shadow s{std::abs(n.dot(d)), std::max(0.0, out - in), 0, 0};
  const double t = (centre - o).dot(n) / d.dot(n);
  const Eigen::Vector3d at = o + t * d - centre;
  if (std::abs(at.dot(a)) < side / 2 && std::abs(at.dot(b)) < side / 2)
    (t < in ? s.in_front : s.inside) = t < in ? s.chord : std::max(0.0, out - t);
  return s;
}

TEST(LeafShadow, IsTheShareOfPathThatLeavesHitInTheVoxelTakeAwayFromLinesOfTheSameDirection) {
  for (const double area : {0.0020, 0.0069, 0.0140})
    for (const double voxel : {0.06, 0.08, 0.12}) {
      std::mt19937_64 rng(5);
      double weights = 0, chords = 0, in_front = 0, inside = 0;
      const int trials = 400000;
      for (int i = 0; i < trials; ++i) {
        const Shadow s = random_shadow(std::sqrt(area), voxel, rng);
        weights += s.weight, chords += s.chord;
        in_front += s.weight * s.in_front, inside += s.weight * s.inside;
      }
      const double norm = trials / (weights * chords);
      const LeafShadow shadow = leaf_shadow(area, voxel);
      EXPECT_NEAR(shadow.in_front, in_front * norm, 0.04 * in_front * norm + 3e-4) << area << " " << voxel;
      EXPECT_NEAR(shadow.inside, inside * norm, 0.04 * inside * norm) << area << " " << voxel;
    }
}

TEST(LeafShadow, VanishesWithTheLeafAndGrowsWithIt) {
  EXPECT_EQ(leaf_shadow(0, 0.08).in_front + leaf_shadow(0, 0.08).inside, 0);
  EXPECT_LT(leaf_shadow(1e-7, 0.08).inside, 1e-4);
  EXPECT_GT(leaf_shadow(0.01, 0.08).in_front, leaf_shadow(0.005, 0.08).in_front);
  EXPECT_GT(leaf_shadow(0.01, 0.08).inside, leaf_shadow(0.005, 0.08).inside);
}

// Wide beams on bare trunks: every neighbour ends at the same depth, as on one endless leaf.
TEST(LeafSize, WhatIsMeasuredCanBeGivenAsAnOption) {
  LeafSizePairs pairs;
  for (int i = 0; i < 20000; ++i) pairs.add(0.012 + 0.001 * (i % 25), 0, true);
  const LeafSize size = estimate_leaf_size(pairs);
  EXPECT_TRUE(size.measured);
  EXPECT_EQ(size.area_m2, LeafSize::kLargestM2);
  EstimatorOptions options;
  options.leaf_size_m2 = size.area_m2;
  EXPECT_TRUE(options.validate());
}

/// Share of pairs of parallel rays `distance_m` apart, one of which has hit a square leaf of that side, in which the
/// other hits it, too, in the usual window: leaves of an ellipsoid's angles, drawn one by one, rays of that elevation.
double share_of_pairs(double ellipsoid_ratio, double sine, double distance_m, double side_m) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  const Eigen::Vector3d ray(std::sqrt(1 - sine * sine), 0, sine), level = Eigen::Vector3d::UnitY();
  double hits = 0, same = 0;
  for (int i = 0; i < 200000; ++i) {
    // Normals of the surface of an ellipsoid, by its area: of the sphere's, weighted with how the map stretches it.
    Eigen::Vector3d on_sphere(normal(engine), normal(engine), normal(engine));
    on_sphere.normalize();
    Eigen::Vector3d n(on_sphere.x(), on_sphere.y(), ellipsoid_ratio * on_sphere.z());
    const double stretch = n.norm();
    n.normalize();
    const double cosine = std::abs(n.dot(ray)), turn = std::numbers::pi * uniform(engine);
    const Eigen::Vector3d beside = std::cos(turn) * level + std::sin(turn) * ray.cross(level);
    const double along = -distance_m * beside.dot(n) / ray.dot(n);
    const Eigen::Vector3d there = distance_m * beside + along * ray;
    const Eigen::Vector3d u = Eigen::AngleAxisd(std::numbers::pi * uniform(engine), n) * n.unitOrthogonal();
    const double share = std::max(0.0, 1 - std::abs(there.dot(u)) / side_m) *
                         std::max(0.0, 1 - std::abs(there.dot(n.cross(u))) / side_m);
    hits += stretch * cosine;
    if (std::abs(along + std::sqrt(2.0) * kUsualWindows.range_noise_m * normal(engine)) < kUsualWindows.window_m)
      same += stretch * cosine * share;
  }
  return same / hits;
}

TEST(ApparentSide, IsThatOfLeavesTurnedAtRandomWithAsManyPairs) {
  const std::array hits{1.0};
  for (const double ratio : {0.6, 1.0, 1.8, 3.0})
    for (const double sine : {0.1, 0.4}) {
      const double side = apparent_side({LeafAngleType::ellipsoidal, ratio}, std::array{sine}, hits);
      EXPECT_NEAR(same_leaf_probability(0.025, 0.08 * side, kUsualWindows), share_of_pairs(ratio, sine, 0.025, 0.08),
                  0.01)
          << ratio << " " << sine;
    }
}

TEST(ApparentSide, FlatLeavesLookSmallToLevelRays) {
  const LeafAngles flat{LeafAngleType::ellipsoidal, 2.5};
  const std::array sines{0.1, 0.6};
  EXPECT_EQ(apparent_side({LeafAngleType::spherical, 1}, sines, std::array{1.0, 1.0}), 1);
  const double level = apparent_side(flat, sines, std::array{1.0, 0.0});
  const double steep = apparent_side(flat, sines, std::array{0.0, 1.0});
  const double both = apparent_side(flat, sines, std::array{1.0, 1.0});
  EXPECT_LT(level, 0.78);
  EXPECT_GT(steep, level + 0.1);
  EXPECT_GT(both, level);
  EXPECT_LT(both, steep);
  EXPECT_EQ(apparent_side(flat, sines, std::array{0.0, 0.0}), 1);
}

}  // namespace
}  // namespace rayfield::density
