#include "rayfield/sim/leaf_box.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rayfield/sim/random.h"

namespace rayfield::sim {
namespace {

SiteLidar lidar_of(double diameter_m) {
  SiteLidar lidar;
  lidar.beam_diameter_m = diameter_m, lidar.max_range_m = 10;
  return lidar;
}

/// Pulses along y through the box, so far from its other faces that every leaf which could stand there does.
std::vector<Pulse> pulses_across(const LeafBoxOptions& options, int count, std::uint64_t seed) {
  constexpr double kRim = 0.1;
  CounterRandom random(seed, Stream::experiment);
  std::vector<Pulse> pulses;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(kRim, options.size_m.x() - kRim);
    const double z = random.uniform(kRim, options.size_m.z() - kRim);
    pulses.push_back({{x, -1, z}, Eigen::Vector3d::UnitY(), i * 1e-3});
  }
  return pulses;
}

TEST(LeafBox, HoldsTheLeavesThatWereAskedFor) {
  const auto box = LeafBox::create({{2, 0.5, 1}, 3, 0.006, 1});
  ASSERT_TRUE(box);
  EXPECT_EQ(box->leaf_count(), 500U);
  EXPECT_NEAR(box->leaf_area_m2(), 3, 1e-9);
}

// Beer and Lambert: exp(−G·density·depth), G = ½ for normals of all directions. Rays through one box meet the same
// leaves, so boxes are the trials.
TEST(LeafBox, LetsThinRaysThroughAsATurbidMediumDoes) {
  constexpr int kBoxes = 40, kRays = 500;
  double sum = 0, squares = 0, strength = 0, strengths = 0, hits = 0;
  for (int b = 0; b < kBoxes; ++b) {
    const LeafBoxOptions options{{3, 0.6, 1.2}, 3, 0.004, static_cast<std::uint64_t>(b)};
    const auto box = LeafBox::create(options);
    ASSERT_TRUE(box);
    const RayBatch rays = box->scan(pulses_across(options, kRays, 100 + options.seed), lidar_of(0), 1);
    double passed = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (rays.hit[i] == 0) {
        ++passed;
        EXPECT_NEAR((rays.end[i] - rays.origin[i]).norm(), 10, 1e-9);
        continue;
      }
      ++hits, strength += rays.intensity[i], strengths += rays.intensity[i] * rays.intensity[i];
    }
    sum += passed / kRays, squares += passed / kRays * passed / kRays;
  }
  const double mean = sum / kBoxes, error = std::sqrt((squares / kBoxes - mean * mean) / (kBoxes - 1));
  EXPECT_NEAR(mean, std::exp(-0.9), 4.5 * error);
  // Rays share leaves; a fourth of them is taken for independent.
  const double full = strength / hits, spread = std::sqrt(strengths / hits - full * full);
  EXPECT_NEAR(full, full_echo_of_random_leaves(), 4.5 * spread / std::sqrt(hits / 4));
}

TEST(LeafBox, EchoesOfWideBeamsAreWeakerThanFullOnesAndMoreOften) {
  const LeafBoxOptions options{{3, 0.6, 1.2}, 1, 0.004, 1};
  const auto box = LeafBox::create(options);
  ASSERT_TRUE(box);
  const auto pulses = pulses_across(options, 4000, 5);
  double hits[2] = {0, 0}, strength[2] = {0, 0};
  for (const int wide : {0, 1}) {
    const RayBatch rays = box->scan(pulses, lidar_of(wide * 0.03), 1);
    for (std::size_t i = 0; i < rays.size(); ++i) hits[wide] += rays.hit[i], strength[wide] += rays.intensity[i];
  }
  EXPECT_GT(hits[1], 1.2 * hits[0]) << "an edge is seen 6 mm outside the leaf";
  EXPECT_LT(strength[1] / hits[1], 0.9 * strength[0] / hits[0]);
}

TEST(LeafBox, SameSeedsGiveTheSameRaysAndOthersOthers) {
  const LeafBoxOptions options;
  const auto one = LeafBox::create(options), two = LeafBox::create(options);
  ASSERT_TRUE(one && two);
  const auto pulses = pulses_across(options, 300, 5);
  const RayBatch a = one->scan(pulses, lidar_of(0.03), 1), b = two->scan(pulses, lidar_of(0.03), 1);
  const RayBatch c = two->scan(pulses, lidar_of(0.03), 2);
  EXPECT_EQ(a.end, b.end);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_NE(a.end, c.end);
}

TEST(LeafBox, RefusesWhatIsOutOfRange) {
  EXPECT_EQ(LeafBox::create({{0, 1, 1}, 3, 0.006, 1}).error().where, "size_m");
  EXPECT_EQ(LeafBox::create({{1, 1, 1}, -1, 0.006, 1}).error().where, "density_m2_m3");
  EXPECT_EQ(LeafBox::create({{1, 1, 1}, 3, 0, 1}).error().where, "leaf_size_m2");
  EXPECT_EQ(LeafBox::create({{100, 100, 100}, 100, 1e-5, 1}).error().code, ErrorCode::usage) << "10¹³ leaves";
}

}  // namespace
}  // namespace rayfield::sim
