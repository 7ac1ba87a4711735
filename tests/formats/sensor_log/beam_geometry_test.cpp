#include "formats/sensor_log/beam_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace rayfield::formats {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A lidar of 16 rings whose lasers look to different sides, as its maker builds them, and whose motor is not steady.
struct Lidar {
  int rings = 16, steps = 720;
  double period_s = 0.1, unsteady_rad = 0.01;
  double elevation(int ring) const { return (-15 + 2.0 * ring) * kDegree; }
  double offset(int ring) const { return (ring % 4 - 1.5) * 3.1 * kDegree; }
  BeamGeometry::Shot shot(int ring, int step, int sweep) const {
    const double t = period_s * step / steps;
    const double head = 2 * std::numbers::pi * step / steps + unsteady_rad * std::sin(40 * (t + period_s * sweep));
    const double a = head + offset(ring), e = elevation(ring);
    return {static_cast<std::uint16_t>(ring), static_cast<float>(t),
            Eigen::Vector3d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)).cast<float>()};
  }
  // Shots of a sweep in the order of time, or ring by ring.
  std::vector<BeamGeometry::Shot> sweep(int number, bool ring_by_ring = false) const {
    std::vector<BeamGeometry::Shot> out;
    for (int k = 0; k < rings * steps; ++k)
      out.push_back(ring_by_ring ? shot(k / steps, k % steps, number) : shot(k % rings, k / rings, number));
    return out;
  }
};

struct Split {
  std::vector<BeamGeometry::Shot> returns, missing;
};

// The sky swallows the upper beams, the more the higher.
Split under_the_sky(const std::vector<BeamGeometry::Shot>& sweep, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Split out;
  for (const auto& s : sweep) {
    const double share = s.ring < 4 ? 0.02 : 0.06 * s.ring;
    (std::uniform_real_distribution<double>()(random) < share ? out.missing : out.returns).push_back(s);
  }
  return out;
}

double largest_error(const BeamGeometry& beams, const std::vector<BeamGeometry::Shot>& missing, std::size_t& found) {
  double largest = 0;
  found = 0;
  for (const auto& s : missing) {
    const auto d = beams.direction(s.ring, s.time_s);
    if (!d) continue;
    ++found;
    largest = std::max(largest, static_cast<double>((*d - s.direction).norm()));
  }
  return largest;
}

TEST(BeamGeometry, GivesMissingShotsTheirDirections) {
  const Lidar lidar;
  for (const bool ring_by_ring : {false, true}) {
    BeamGeometry beams;
    std::size_t found = 0;
    for (int number = 0; number < 5; ++number) {
      const Split split = under_the_sky(lidar.sweep(number, ring_by_ring), 7 + static_cast<std::uint64_t>(number));
      beams.learn(split.returns);
      EXPECT_LT(largest_error(beams, split.missing, found), 0.1 * kDegree) << "sweep " << number;
      EXPECT_GT(found, split.missing.size() * 98 / 100) << "sweep " << number;
    }
  }
}

TEST(BeamGeometry, DoesNotGuessWhereNoBeamReturnedAnything) {
  const Lidar lidar;
  std::vector<BeamGeometry::Shot> returns, covered;
  for (const auto& s : lidar.sweep(0)) (s.time_s > 0.03F && s.time_s < 0.05F ? covered : returns).push_back(s);
  BeamGeometry beams;
  beams.learn(returns);
  std::size_t found = 0;
  largest_error(beams, covered, found);
  EXPECT_LT(found, covered.size() / 20);  // the bins at the two edges
}

TEST(BeamGeometry, DoesNotGuessTheElevationOfARingThatReturnsNothing) {
  const Lidar lidar;
  std::vector<BeamGeometry::Shot> returns;
  for (const auto& s : lidar.sweep(0))
    if (s.ring != 15) returns.push_back(s);
  BeamGeometry beams;
  beams.learn(returns);
  EXPECT_TRUE(beams.direction(14, 0.05F));
  EXPECT_FALSE(beams.direction(15, 0.05F));
  EXPECT_FALSE(beams.direction(200, 0.05F));
}

TEST(BeamGeometry, LeavesLidarsAloneWhoseRingsAreNoCones) {
  std::mt19937_64 random(3);
  std::normal_distribution<float> spread(0, 0.3F);
  std::vector<BeamGeometry::Shot> returns;
  for (int k = 0; k < 20000; ++k) {
    const Eigen::Vector3f d(1, spread(random), spread(random));
    returns.push_back({static_cast<std::uint16_t>(k % 6), 5e-6F * static_cast<float>(k), d.normalized()});
  }
  BeamGeometry beams;
  beams.learn(returns);
  for (int ring = 0; ring < 6; ++ring) EXPECT_FALSE(beams.direction(static_cast<std::uint16_t>(ring), 0.05F));
}

TEST(BeamGeometry, LeavesCloudsAloneThatWereCorrectedForMotion) {
  const Lidar lidar;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> range(1.0, 3.0);
  std::vector<BeamGeometry::Shot> returns;
  for (auto s : lidar.sweep(0)) {
    const Eigen::Vector3d moved =
        range(random) * s.direction.cast<double>() + Eigen::Vector3d(2.5, 0, 0) * double{s.time_s};
    s.direction = moved.normalized().cast<float>();
    returns.push_back(s);
  }
  BeamGeometry beams;
  beams.learn(returns);
  EXPECT_FALSE(beams.direction(3, 0.05F));
}

TEST(BeamGeometry, TakesWhateverItIsGiven) {
  BeamGeometry beams;
  beams.learn({});
  EXPECT_FALSE(beams.direction(0, 0));
  std::vector<BeamGeometry::Shot> same(5000);
  beams.learn(same);
  EXPECT_FALSE(beams.direction(0, 0));
  for (auto& s : same) s.ring = 65535;
  beams.learn(same);
  EXPECT_FALSE(beams.direction(65535, 0));
  EXPECT_FALSE(beams.direction(0, std::numeric_limits<float>::quiet_NaN()));
}

}  // namespace
}  // namespace rayfield::formats
