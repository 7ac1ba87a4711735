#include "formats/sensor_log/first_echoes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rayfield::formats {
namespace {

using ::testing::ElementsAre;

constexpr float kInf = INFINITY, kNan = NAN;

Rig::Lidar lidar_of(NoReturn no_return = NoReturn::infinity) {
  Rig::Lidar lidar;
  lidar.min_range_m = 0.5, lidar.max_range_m = 30, lidar.no_return = no_return;
  return lidar;
}

// The range that counts, NaN where there is no echo at all, and how many later ones there are.
std::pair<float, std::size_t> first_of(const std::vector<float>& echoes, NoReturn no_return = NoReturn::infinity) {
  const auto first = first_echo(echoes, lidar_of(no_return));
  return first ? std::pair(echoes[first->index], first->later) : std::pair(kNan, std::size_t{0});
}

TEST(FirstEcho, IsTheNearestReturnInAnyOrder) {
  std::vector<float> echoes = {7, 2, 12};
  std::sort(echoes.begin(), echoes.end());
  do {
    EXPECT_EQ(first_of(echoes), std::pair(2.0F, std::size_t{2}));
  } while (std::next_permutation(echoes.begin(), echoes.end()));
  EXPECT_FALSE(first_echo({}, lidar_of()));
  EXPECT_EQ(first_of({7}), std::pair(7.0F, std::size_t{0}));
}

TEST(FirstEcho, PassesOverWhatIsNoReturn) {
  EXPECT_EQ(first_of({0.2F, 5, 40, kNan, kInf}), std::pair(5.0F, std::size_t{0}));
  EXPECT_EQ(first_of({0, 5}, NoReturn::zero), std::pair(5.0F, std::size_t{0}));
  EXPECT_EQ(first_of({5, 30}, NoReturn::max_range), std::pair(5.0F, std::size_t{0}));
  // Without a return the beam met what is too close, else nothing.
  EXPECT_EQ(first_of({kInf, 0.2F}), std::pair(0.2F, std::size_t{0}));
  EXPECT_EQ(first_of({kNan, kInf}), std::pair(kInf, std::size_t{0}));
}

TEST(FirstEcho, AnEchoSentTwiceIsOne) {
  EXPECT_EQ(first_of({5, 5}), std::pair(5.0F, std::size_t{0}));
  EXPECT_EQ(first_of({5, 5.004F, 8, 8}), std::pair(5.0F, std::size_t{1}));
}

CloudPoint point(int ring, float time_s, Eigen::Vector3f direction, float range_m) {
  return {static_cast<std::uint16_t>(ring), time_s, direction.normalized(), range_m, range_m};
}
CloudPoint gap(int ring, float time_s) {
  return {static_cast<std::uint16_t>(ring), time_s, Eigen::Vector3f::Zero(), kNan, 0};
}
std::vector<float> ranges_of(const std::vector<CloudPoint>& points) {
  std::vector<float> ranges;
  for (const CloudPoint& p : points) ranges.push_back(p.placed() ? p.range_m : -1);
  return ranges;
}

// As a lidar with two returns sends them: all last ones of a moment, then all strongest ones.
TEST(KeepFirstEchoes, OfBlocksThatFollowEachOther) {
  std::vector<CloudPoint> points;
  for (const bool second : {false, true})
    for (int firing = 0; firing < 2; ++firing)
      for (int ring = 0; ring < 3; ++ring) {
        const float first_m = 2.0F + static_cast<float>(ring), time_s = 1e-3F * static_cast<float>(firing);
        const Eigen::Vector3f direction(1, 0.01F * static_cast<float>(firing), 0.03F * static_cast<float>(ring));
        points.push_back(point(ring, time_s, direction, ring == 1 || second ? first_m : first_m + 3));
      }
  EXPECT_EQ(keep_first_echoes(points, true, lidar_of()), 4U);  // ring 1 has the same one twice
  EXPECT_THAT(ranges_of(points), ElementsAre(3, 3, 2, 4, 2, 4));
  for (const CloudPoint& p : points) EXPECT_EQ(p.intensity, p.range_m);
}

TEST(KeepFirstEchoes, AMissingSecondEchoIsNoShotWithoutAReturn) {
  const Eigen::Vector3f ahead(1, 0, 0);
  std::vector<CloudPoint> points = {point(0, 0, ahead, 4), gap(1, 0), gap(0, 0), gap(1, 0)};
  EXPECT_EQ(keep_first_echoes(points, true, lidar_of()), 0U);
  EXPECT_THAT(ranges_of(points), ElementsAre(4, -1));
  // Without rings nothing says which beam a point without a place is of.
  points = {point(0, 0, ahead, 4), gap(0, 0)};
  EXPECT_EQ(keep_first_echoes(points, false, lidar_of()), 0U);
  EXPECT_EQ(points.size(), 2U);
}

TEST(KeepFirstEchoes, BeamsBesideEachOtherStay) {
  // No rings and one time for a whole sweep, 0.1° apart.
  std::vector<CloudPoint> points;
  for (int i = 0; i < 400; ++i) {
    const double azimuth = 0.1 * i * M_PI / 180;
    const Eigen::Vector3f direction(static_cast<float>(std::cos(azimuth)), static_cast<float>(std::sin(azimuth)), 0);
    points.push_back(point(0, 0, direction, 5.0F + static_cast<float>(i % 7)));
  }
  const std::vector<float> before = ranges_of(points);
  EXPECT_EQ(keep_first_echoes(points, false, lidar_of()), 0U);
  EXPECT_EQ(ranges_of(points), before);
}

// As of a scanner in a plane whose driver gives all points of a sweep one time.
TEST(KeepFirstEchoes, OfOneTimeInOnePlane) {
  std::vector<CloudPoint> points;
  constexpr int kBeams = 5000;  // 1.3 mrad apart
  for (const float behind_m : {0.0F, 3.0F})
    for (int i = 0; i < kBeams; ++i) {
      const double azimuth = 2 * M_PI * (i * 7919 % kBeams) / kBeams;
      const Eigen::Vector3f direction(static_cast<float>(std::cos(azimuth)), static_cast<float>(std::sin(azimuth)), 0);
      if (behind_m == 0 || i % 2 == 0) points.push_back(point(0, 0, direction, 5 + behind_m));
    }
  EXPECT_EQ(keep_first_echoes(points, false, lidar_of()), kBeams / 2U);
  EXPECT_EQ(points.size(), std::size_t{kBeams});
  for (const CloudPoint& p : points) EXPECT_EQ(p.range_m, 5);
}

// Places in whole millimetres, in an order that says nothing.
TEST(KeepFirstEchoes, OfShuffledPointsWithoutRings) {
  std::mt19937 random(3);
  std::vector<CloudPoint> points;
  const auto rounded = [](const Eigen::Vector3f& direction, float range_m) {
    const Eigen::Vector3f p = 1e-3F * (1e3F * range_m * direction.normalized()).array().round().matrix();
    return point(0, 0, p, p.norm());
  };
  std::uniform_real_distribution<float> range(2, 6), slope(-0.4F, 0.4F);
  std::vector<float> firsts;
  for (int beam = 0; beam < 40; ++beam) {
    const Eigen::Vector3f direction(1, 0.05F * static_cast<float>(beam), slope(random));
    const float first_m = range(random);
    for (int echo = 0; echo < 1 + beam % 3; ++echo)
      points.push_back(rounded(direction, first_m + 2 * static_cast<float>(echo)));
    firsts.push_back(first_m);
  }
  std::shuffle(points.begin(), points.end(), random);
  EXPECT_EQ(keep_first_echoes(points, false, lidar_of()), 39U);
  std::vector<float> kept = ranges_of(points);
  std::sort(kept.begin(), kept.end()), std::sort(firsts.begin(), firsts.end());
  ASSERT_EQ(kept.size(), firsts.size());
  for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_NEAR(kept[i], firsts[i], 1e-3);
}

}  // namespace
}  // namespace rayfield::formats
