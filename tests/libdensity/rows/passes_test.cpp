#include "libdensity/rows/passes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/libdensity/scene.h"

namespace rayfield::density {
namespace {

std::vector<PathPoint> path_of(const std::vector<Eigen::Vector2d>& points) {
  std::vector<PathPoint> path;
  for (std::size_t i = 0; i < points.size(); ++i)
    path.push_back({0.1 * static_cast<double>(i), {points[i].x(), points[i].y(), 0}});
  return path;
}

// Up a lane of 30 m, half a circle of 1.25 m radius, back down.
std::vector<Eigen::Vector2d> there_and_back() {
  std::vector<Eigen::Vector2d> line;
  for (int i = 0; i <= 240; ++i) line.emplace_back(0, 0.125 * i);
  for (int i = 1; i < 32; ++i)
    line.emplace_back(1.25 - 1.25 * std::cos(M_PI * i / 32), 30 + 1.25 * std::sin(M_PI * i / 32));
  for (int i = 0; i <= 240; ++i) line.emplace_back(2.5, 30 - 0.125 * i);
  return line;
}

TEST(Passes, AreCutAtTheHeadlandTurn) {
  const auto passes = find_passes(path_of(there_and_back()), {});
  ASSERT_EQ(passes.size(), 2U);
  for (const Pass& pass : passes) EXPECT_NEAR(pass.length_m(), 30, 2.5);
  EXPECT_GT(passes[0].line.back().y(), passes[0].line.front().y());
  EXPECT_LT(passes[1].line.back().y(), passes[1].line.front().y());
  EXPECT_LT(passes[0].end_time_s, passes[1].start_time_s);
}

TEST(Passes, FollowCurvedLanesInOnePiece) {
  std::vector<Eigen::Vector2d> arc;
  for (int i = 0; i <= 400; ++i) arc.emplace_back(60 * std::cos(0.002 * i), 60 * std::sin(0.002 * i));
  const auto passes = find_passes(path_of(arc), {});
  ASSERT_EQ(passes.size(), 1U);
  EXPECT_NEAR(passes[0].length_m(), 48, 1);
}

TEST(Passes, AreCutWhereTheTrackJumpsAndIgnoreStandstills) {
  std::vector<Eigen::Vector2d> line;
  for (int i = 0; i <= 100; ++i) line.emplace_back(0.1 * i, 0);
  for (int i = 0; i < 500; ++i) line.emplace_back(10 + 0.01 * std::sin(i), 0.01 * std::cos(i));  // waiting
  for (int i = 0; i <= 100; ++i) line.emplace_back(10 + 0.1 * i, 0);
  for (int i = 0; i <= 100; ++i) line.emplace_back(40 + 0.1 * i, 5);  // elsewhere
  const auto passes = find_passes(path_of(line), {});
  ASSERT_EQ(passes.size(), 2U);
  EXPECT_NEAR(passes[0].length_m(), 20, 0.6);
  EXPECT_NEAR(passes[1].length_m(), 10, 0.6);
}

TEST(Passes, OfNoPathAreNone) { EXPECT_TRUE(find_passes({}, {}).empty()); }

}  // namespace
}  // namespace rayfield::density
