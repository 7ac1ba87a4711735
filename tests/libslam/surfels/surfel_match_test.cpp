#include "libslam/surfels/surfel_match.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace rayfield::slam {
namespace {

PlacedSurfel placed(float x, float y, float z, const Eigen::Vector3f& n, float time) {
  return {Eigen::Vector3f(x, y, z), n.normalized(), time, 0};
}

MatchQuery query() {
  MatchQuery q;
  q.radius_voxels = 1;
  return q;
}

const std::vector<double> kOneMetre = {1.0};
const Eigen::Vector3f kUp(0, 0, 1);

TEST(MutualMatches, PairsNearestNeighboursOfDifferentTimes) {
  const std::vector<PlacedSurfel> s = {placed(0, 0, 0, kUp, 0), placed(0.1f, 0, 0, kUp, 2), placed(0.4f, 0, 0, kUp, 2),
                                       placed(0.05f, 0, 0, kUp, 0.2f)};
  const auto m = mutual_matches(s, kOneMetre, query(), 1);
  // 3 and 1 are nearest to each other; 0 prefers 1, which prefers 3; 2 prefers 3.
  ASSERT_EQ(m.size(), 1u);
  EXPECT_EQ(m[0].first, 1u);
  EXPECT_EQ(m[0].second, 3u);
}

TEST(MutualMatches, KeepsApartWhatFacesOppositeWays) {
  // Two sides of a thin wall, 5 cm apart.
  const std::vector<PlacedSurfel> s = {placed(0, 0, 0, {1, 0, 0}, 0), placed(0.05f, 0, 0, {-1, 0, 0}, 3)};
  MatchQuery q = query();
  q.normal_scale_m = 0.6;
  EXPECT_TRUE(mutual_matches(s, kOneMetre, q, 1).empty());
}

TEST(MutualMatches, RefusesPairsBeyondTheBoundThatGuardsAgainstTheNextRow) {
  // The same canopy side, one row (2.5 m) on.
  const std::vector<PlacedSurfel> s = {placed(0, 0, 0, {1, 0, 0}, 0), placed(2.5f, 0, 0, {1, 0, 0}, 60)};
  MatchQuery q = query();
  q.radius_voxels = 4;
  ASSERT_EQ(mutual_matches(s, kOneMetre, q, 1).size(), 1u);
  q.max_radius_m = 1.25;
  EXPECT_TRUE(mutual_matches(s, kOneMetre, q, 1).empty());
}

TEST(MutualMatches, AgreesWithExhaustiveSearchAtAnyNumberOfThreads) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> u(-6, 6), d(-1, 1), time(0, 20);
  std::vector<PlacedSurfel> s;
  for (int k = 0; k < 9000; ++k)
    s.push_back(
        placed(u(generator), u(generator), 0.2f * u(generator), {d(generator), d(generator), 1}, time(generator)));
  MatchQuery q = query();
  q.radius_voxels = 0.5;
  q.min_gap_s = 1, q.max_gap_s = 15;
  std::vector<std::size_t> nearest(s.size(), s.size());
  for (std::size_t a = 0; a < s.size(); ++a) {
    float best = 0.25f;
    for (std::size_t b = 0; b < s.size(); ++b) {
      const float gap = std::abs(s[a].time_s - s[b].time_s);
      const float e = (s[b].center - s[a].center).squaredNorm() + 0.25f * (s[b].normal - s[a].normal).squaredNorm();
      if (gap >= 1 && gap < 15 && e < best) best = e, nearest[a] = b;
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> expected;
  for (std::size_t a = 0; a < s.size(); ++a)
    if (nearest[a] < s.size() && nearest[a] > a && nearest[nearest[a]] == a) expected.emplace_back(a, nearest[a]);
  ASSERT_GT(expected.size(), 500u);
  for (int threads : {1, 3}) {
    std::vector<std::pair<std::size_t, std::size_t>> found;
    for (const SurfelMatch& m : mutual_matches(s, kOneMetre, q, threads)) found.emplace_back(m.first, m.second);
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace rayfield::slam
