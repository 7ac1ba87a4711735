#include "libdensity/ground/lower_hull.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::density {
namespace {

TEST(LowerHull, RefusesDegeneratePointsAndSaysWhy) {
  const double nan = std::nan("");
  const std::vector<Eigen::Vector3d> few{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {nan, 0, 0}};
  EXPECT_NE(lower_hull(few, 0.1).error().why.find("fewer than four"), std::string::npos);
  std::vector<Eigen::Vector3d> line, same(20, Eigen::Vector3d(1, 2, 3)), bowl;
  for (int i = 0; i < 20; ++i) line.emplace_back(i, 2 * i, std::sin(i));
  EXPECT_NE(lower_hull(line, 0.1).error().why.find("one line"), std::string::npos);
  EXPECT_FALSE(lower_hull(same, 0.1));
  for (int i = 0; i < 20; ++i) {  // z = −k r² about the centre of mass: flat once lifted
    const double a = 2 * M_PI * i / 20;
    bowl.emplace_back(2 * std::cos(a), 2 * std::sin(a), -0.4);
  }
  EXPECT_NE(lower_hull(bowl, 0.1).error().why.find("one plane"), std::string::npos);
}

TEST(LowerHull, KeepsPointsThatCurveLessThanTheParaboloidAndDropsThoseThatCurveMore) {
  // A grid on z = c·x²: with −c < k every point is a vertex of the lower hull, a bump of more is bridged.
  std::vector<Eigen::Vector3d> points;
  for (int i = -10; i <= 10; ++i)
    for (int j = -10; j <= 10; ++j) points.emplace_back(i, j, i == 0 && j == 0 ? 0.15 : -0.05 * 0.01 * i * i);
  const auto hull = lower_hull(points, 0.1);
  ASSERT_TRUE(hull);
  std::vector<bool> used(points.size(), false);
  double area = 0;
  for (const auto& t : hull->triangles) {
    const Eigen::Vector2d a = points[static_cast<std::size_t>(t[0])].head<2>(),
                          b = points[static_cast<std::size_t>(t[1])].head<2>(),
                          c = points[static_cast<std::size_t>(t[2])].head<2>();
    area += 0.5 * ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
    for (int v : t) used[static_cast<std::size_t>(v)] = true;
  }
  EXPECT_NEAR(area, 400, 1e-6);  // covers the square once
  // The four neighbours hold the middle down: a point may stand at most k·1² = 0.1 above them.
  EXPECT_FALSE(used[10 * 21 + 10]);
  EXPECT_EQ(std::count(used.begin(), used.end(), true), 21 * 21 - 1);
}

}  // namespace
}  // namespace rayfield::density
