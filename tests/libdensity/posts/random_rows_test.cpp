// Rows put together at random: whatever the spacing of posts and vines, a block must have its panels. What stems look
// like is as simulated scans show them (docs/rows.md, "What it reaches").
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "libdensity/posts/posts.h"

namespace rayfield::density {
namespace {

struct Look {
  double tall_vines = 0;    // share of the vines whose canes stand on their axis and look as high as posts
  double hidden_posts = 0;  // share of the posts within rows of which foliage hides the upper half
  double missing_posts = 0;
};

class RandomRows {
 public:
  RandomRows(unsigned seed, Look look) : random_(seed), look_(look) {
    post_m_ = uniform(3.2, 8), vine_m_ = uniform(0.9, 2.2);
    panels_ = whole(4, 12), rows_ = whole(3, 6);
    for (int r = 1; r <= rows_; ++r) add_row(r);
  }

  bool has_its_panels() {
    if (!place_posts(layout_, stems_, {})) return false;
    return static_cast<int>(layout_.panels.size()) == rows_ * panels_;
  }

 private:
  double uniform(double a, double b) { return std::uniform_real_distribution<>(a, b)(random_); }
  double normal(double mean, double sd) { return std::normal_distribution<>(mean, sd)(random_); }
  int whole(int a, int b) { return std::uniform_int_distribution<>(a, b)(random_); }
  bool chance(double share) { return uniform(0, 1) < share; }

  void add_row(int number) {
    constexpr double kRowSpacingM = 3, kStartM = 0.1;
    const double end_m = kStartM + post_m_ * panels_;
    Row row;
    row.number = number;
    for (double x = 0; x <= end_m + 0.1; x += 0.5) row.centreline.push_back({x, kRowSpacingM * number});
    layout_.rows.push_back(row);
    for (int k = 0; k <= panels_; ++k) {
      const bool is_end = k == 0 || k == panels_;
      if (!is_end && chance(look_.missing_posts)) continue;
      Stem post = is_end ? end_post() : line_post();
      post.row = number;
      post.position = {kStartM + k * post_m_ + uniform(-0.02, 0.02), kRowSpacingM * number};
      stems_.push_back(post);
    }
    for (double x = kStartM + uniform(0.3, vine_m_); x < end_m - 0.2; x += vine_m_) {
      const double place = (x - kStartM) / post_m_;
      if (std::abs(place - std::round(place)) * post_m_ < 0.2) continue;  // no room beside a post
      Stem grown = vine();
      grown.row = number;
      grown.position = {x + uniform(-0.05, 0.05), kRowSpacingM * number + uniform(-0.04, 0.04)};
      stems_.push_back(grown);
    }
  }

  Stem end_post() {
    return {.radius_m = normal(0.058, 0.002), .top_m = 1.92, .contrast = 300, .upper_share = 1.4, .solidity = 60};
  }
  Stem line_post() {
    const bool hidden = chance(look_.hidden_posts);
    return {.radius_m = normal(0.036, 0.0025),
            .top_m = hidden ? uniform(0.7, 1.1) : normal(1.81, 0.01),
            .contrast = 350,
            .upper_share = hidden ? 0 : uniform(1.1, 1.6)};
  }
  Stem vine() {
    const bool tall = chance(look_.tall_vines);
    return {.radius_m = normal(0.025, 0.003),
            .top_m = tall ? uniform(1.5, 1.8) : normal(0.94, 0.05),
            .contrast = 110,
            .upper_share = tall ? uniform(0.5, 1.7) : 0};
  }

  std::mt19937 random_;
  Look look_;
  double post_m_ = 0, vine_m_ = 0;
  int panels_ = 0, rows_ = 0;
  RowLayout layout_;
  std::vector<Stem> stems_;
};

int blocks_with_wrong_panels(Look look) {
  int wrong = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) wrong += RandomRows(seed, look).has_its_panels() ? 0 : 1;
  return wrong;
}

TEST(RandomRows, BareBlocksHaveTheirPanels) { EXPECT_EQ(blocks_with_wrong_panels({}), 0); }

TEST(RandomRows, TallVinesHardlyMatter) {
  EXPECT_EQ(blocks_with_wrong_panels({.tall_vines = 0.1}), 0);
  EXPECT_LE(blocks_with_wrong_panels({.tall_vines = 0.5}), 4);
}

TEST(RandomRows, NorDoPostsThatFoliageHides) {
  EXPECT_LE(blocks_with_wrong_panels({.tall_vines = 0.1, .hidden_posts = 0.4}), 4);
}

TEST(RandomRows, MissingPostsAreInferred) {
  EXPECT_LE(blocks_with_wrong_panels({.tall_vines = 0.1, .missing_posts = 0.1}), 4);
  EXPECT_LE(blocks_with_wrong_panels({.tall_vines = 0.1, .missing_posts = 0.25}), 10);
}

}  // namespace
}  // namespace rayfield::density
