// Posts near the ends of rows.
#include <gtest/gtest.h>

#include <cmath>

#include "libdensity/posts/posts.h"

namespace rayfield::density {
namespace {

// Three rows of 19.2 m with posts every six metres, the last of which is 1.2 m before the end post, where panels do not
// fit the row's length. Vines every 1.5 m.
std::size_t panels_of(const Stem& last) {
  constexpr double kRowSpacingM = 3, kLengthM = 19.2;
  RowLayout layout;
  std::vector<Stem> stems;
  const auto add = [&](Stem stem, int row, double x) {
    stem.row = row, stem.position = {x, kRowSpacingM * row}, stem.contrast = 100;
    stems.push_back(stem);
  };
  const Stem end_post{.radius_m = 0.058, .top_m = 1.9, .upper_share = 1.4, .solidity = 60};
  const Stem line_post{.radius_m = 0.04, .top_m = 1.8, .upper_share = 1.4, .solidity = 60};
  for (int number = 1; number <= 3; ++number) {
    Row row;
    row.number = number;
    for (double x = 0; x < kLengthM + 0.1; x += 0.4) row.centreline.push_back({x, kRowSpacingM * number});
    layout.rows.push_back(row);
    add(end_post, number, 0), add(end_post, number, kLengthM);
    for (const double x : {6.0, 12.0}) add(line_post, number, x);
    add(last, number, 18);
    for (double x = 0.75; x < kLengthM; x += 1.5)
      if (std::abs(x - 18) > 0.3) add({.radius_m = 0.024 + 0.002 * std::sin(7 * x), .top_m = 0.9}, number, x);
  }
  return place_posts(layout, stems, {}) ? layout.panels.size() : 0;
}

TEST(EndPosts, StandBesideALinePostWherePanelsDoNotFitTheRow) {
  EXPECT_EQ(panels_of({.radius_m = 0.04, .top_m = 1.8, .upper_share = 1.4, .solidity = 60}), 12U);
}

// As high as a post, and as thin as vines: it is one.
TEST(EndPosts, AreNoneBesideATallVine) {
  EXPECT_EQ(panels_of({.radius_m = 0.026, .top_m = 1.7, .upper_share = 0.8, .solidity = 2}), 9U);
}

}  // namespace
}  // namespace rayfield::density
