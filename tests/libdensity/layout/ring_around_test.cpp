#include "libdensity/layout/ring_around.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libdensity/layout/polyline.h"

namespace rayfield::density {
namespace {

using Line = std::vector<Eigen::Vector2d>;

// Twice the signed area of a triangle.
double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool crosses_itself(const Line& ring) {
  for (std::size_t i = 0; i + 1 < ring.size(); ++i)
    for (std::size_t k = i + 2; k + 1 < ring.size(); ++k) {
      if (i == 0 && k + 2 == ring.size()) continue;  // neighbours around the corner
      const Eigen::Vector2d &a = ring[i], &b = ring[i + 1], &c = ring[k], &d = ring[k + 1];
      if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) return true;
    }
  return false;
}

// An arc of 50 m radius with a vertex every half metre, and an end one millimetre behind the last.
Line arc_with_a_short_end() {
  Line line;
  for (int i = 0; i <= 14; ++i) line.emplace_back(50 * std::cos(0.01 * i), 50 * std::sin(0.01 * i));
  const double end = 0.14 + 0.001 / 50;
  line.emplace_back(50 * std::cos(end), 50 * std::sin(end));
  return line;
}

TEST(RingAround, DoesNotCrossItselfWhereACurvedLineEndsJustBehindAVertex) {
  const Line line = arc_with_a_short_end();
  for (const double half_width : {0.2, 0.5, 1.5}) {
    const Line ring = ring_around(line, half_width);
    EXPECT_FALSE(crosses_itself(ring)) << half_width;
    EXPECT_EQ(ring.front(), ring.back());
    double area = 0;
    for (std::size_t i = 0; i + 1 < ring.size(); ++i) area += turn(ring[0], ring[i], ring[i + 1]) / 2;
    EXPECT_NEAR(area, polyline_length(line) * 2 * half_width, 0.002 * half_width) << "counter-clockwise";
  }
}

TEST(RingAround, KeepsBothEndsOfAStraightLine) {
  const Line ring = ring_around(Line{{0, 0}, {3, 0}, {3.05, 0}}, 1);
  ASSERT_EQ(ring.size(), 5U);
  EXPECT_EQ(ring[0], Eigen::Vector2d(0, -1));
  EXPECT_EQ(ring[1], Eigen::Vector2d(3.05, -1));
  EXPECT_EQ(ring[2], Eigen::Vector2d(3.05, 1));
  EXPECT_EQ(ring[3], Eigen::Vector2d(0, 1));
}

TEST(RingAround, OfNothingIsNothing) { EXPECT_TRUE(ring_around({}, 1).empty()); }

}  // namespace
}  // namespace rayfield::density
