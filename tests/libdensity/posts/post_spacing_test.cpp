#include "libdensity/posts/post_spacing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace rayfield::density {
namespace {

/// Sure posts of rows at some chainages, some of them `low`.
struct Rows {
  std::vector<std::vector<PlacedStem>> stems;
  std::vector<std::vector<std::size_t>> sure;

  void add(const std::vector<double>& chainages_m, const std::vector<double>& low_m = {}) {
    std::vector<std::size_t> all;
    std::vector<PlacedStem> row;
    for (const double chainage_m : chainages_m) {
      all.push_back(row.size());
      row.push_back({{}, chainage_m, 0});
      const bool low = std::find(low_m.begin(), low_m.end(), chainage_m) != low_m.end();
      row.back().stem.top_m = low ? 1.55 : 1.8;
    }
    stems.push_back(row), sure.push_back(all);
  }
  UsualSpacing spacing() const { return usual_spacing(stems, sure, stem_thickness(stems, sure), 2.5, 15); }
};

TEST(PostSpacing, PostsTellTheirSpacing) {
  Rows rows;
  rows.add({0, 5, 10, 15, 20});
  rows.add({0.1, 5.1, 15.1, 20.1});  // one is not seen
  EXPECT_NEAR(rows.spacing().spacing_m, 5, 1e-9);
  EXPECT_TRUE(rows.spacing().regular);
}

// Vines a metre apart stand half-way between posts five metres apart, too; a few of them are as tall.
TEST(PostSpacing, AFewTallVinesHalfwayDoNotHalveIt) {
  Rows rows;
  rows.add({0, 5, 9.99, 12.52, 14.99, 17.46, 19.99}, {12.52, 17.46});
  rows.add({0, 5, 10, 15, 20});
  rows.add({0, 5.01, 9.99, 14.99, 17.54, 19.99}, {17.54});
  EXPECT_NEAR(rows.spacing().spacing_m, 5, 0.02);
  EXPECT_TRUE(rows.spacing().regular);
}

// In full leaf, with the upper half of some posts hidden.
TEST(PostSpacing, PostsThatFoliageHidesAreNotTakenForLowOnes) {
  Rows rows;
  rows.add({0, 5, 10, 15, 17.5, 20}, {17.5});
  rows.add({0, 5, 10, 12.5, 15, 20}, {12.5});
  rows.add({0, 5, 10, 15, 20});
  rows.stems[0][1].stem.top_m = rows.stems[0][2].stem.top_m = rows.stems[1][1].stem.top_m = 0.9;
  EXPECT_NEAR(rows.spacing().spacing_m, 5, 1e-9);
}

// In full leaf canes make vines as high as posts. Posts are set out to the centimetre here, and these stand 12 and 16
// cm off the middle between two.
TEST(PostSpacing, VinesAsHighAsPostsStandOffTheirPlaces) {
  Rows rows;
  rows.add({0, 2.87, 5.5, 10.98, 16.5, 19.09, 21.99});
  rows.add({0, 5.5, 10.99, 16.49, 21.99});
  EXPECT_NEAR(rows.spacing().spacing_m, 5.5, 0.02);
}

/// Three rows of 22 m with a post every 5.5 m and a vine every 1.83 m, so that three vines stand about half-way between
/// two posts each. Posts have 34 mm, vines 24 ± 3; `is_tall(row, vine)` are as high as posts.
constexpr std::array kVineRadiiM{0.024, 0.021, 0.026, 0.023, 0.018, 0.027, 0.024, 0.030, 0.022};

template <class IsTall>
Rows rows_with_vines(const IsTall& is_tall) {
  Rows rows;
  for (int row = 0; row < 3; ++row) {
    std::vector<std::pair<double, bool>> at;  // chainage, and whether it is a post
    for (int post = 0; post < 5; ++post) at.emplace_back(5.5 * post, true);
    for (int vine = 0; vine < 12; ++vine) at.emplace_back(0.92 + 0.03 * row + 1.83 * vine, false);
    std::sort(at.begin(), at.end());
    std::vector<PlacedStem> stems;
    std::vector<std::size_t> sure;
    int vine = 0;
    for (const auto& [chainage_m, is_post] : at) {
      if (is_post || is_tall(row, vine)) sure.push_back(stems.size());
      stems.push_back({{}, chainage_m, 0});
      stems.back().stem.radius_m = is_post ? 0.034 : kVineRadiiM[static_cast<std::size_t>(5 * vine + 7 * row) % 9];
      vine += is_post ? 0 : 1;
    }
    rows.stems.push_back(stems), rows.sure.push_back(sure);
  }
  return rows;
}

// Bare vines with canes on their axes: half of them look like posts, half-way and everywhere.
TEST(PostSpacing, VinesOfWhichManyAreTallDoNotHalveIt) {
  const std::vector<std::vector<int>> tall{{1, 2, 3, 6, 8, 9, 10, 11}, {0, 4, 6, 10, 11}, {1, 4, 5, 7, 9}};
  const Rows rows = rows_with_vines([&](int row, int vine) { return std::ranges::count(tall[row], vine) > 0; });
  EXPECT_NEAR(rows.spacing().spacing_m, 5.5, 1e-9);
  EXPECT_TRUE(rows.spacing().regular);
}

// Even where it is a third of those half-way and no others, as long as they are as thin as vines.
TEST(PostSpacing, VinesHalfwayAreThinnerThanPosts) {
  const auto is_halfway = [](int, int vine) { return vine % 3 == 1; };
  Rows rows = rows_with_vines([&](int row, int vine) { return is_halfway(row, vine) && (vine / 3 + row) % 3 == 0; });
  EXPECT_NEAR(rows.spacing().spacing_m, 5.5, 1e-9);
}

// As thick as posts, and as high wherever foliage lets it be seen, they are posts.
TEST(PostSpacing, PostsHalfwayThatStandAtVinesAreThick) {
  Rows rows = rows_with_vines([](int row, int vine) { return vine % 3 == 1 && (vine / 3 + row) % 4 != 0; });
  for (auto& row : rows.stems)
    for (PlacedStem& stem : row)
      if (std::abs(std::remainder(stem.chainage_m, 2.75)) < 0.15) stem.stem.radius_m = 0.034;
  EXPECT_NEAR(rows.spacing().spacing_m, 2.75, 0.03);
}

// Two of three that can be seen are as many as foliage may leave of posts.
TEST(PostSpacing, MostPostsHalfwayDo) {
  Rows rows;
  rows.add({0, 5, 7.5, 10, 12.5, 15, 17.5, 20});
  rows.add({0, 2.5, 5, 10, 12.5, 15, 20});
  rows.add({0, 2.5, 5, 7.5, 10, 15, 17.5, 20});
  EXPECT_NEAR(rows.spacing().spacing_m, 2.5, 1e-9);
}

TEST(PostSpacing, PostsOfWhichManyAreNotSeenKeepTheirSpacing) {
  Rows rows;
  rows.add({0, 4, 12, 20, 28, 32});
  rows.add({4, 8, 16, 20, 24});
  rows.add({0, 8, 12, 16, 24, 28});
  EXPECT_NEAR(rows.spacing().spacing_m, 4, 1e-9);
}

// Between two vines 1.4 m apart stands a post, and the vine nearest to it seems to stand between two as well: a post
// and that vine are one place of the spacing. Counted twice, what stands at 8 m outweighed what 4 m add.
TEST(PostSpacing, AVineBesideAPostIsNotASecondOne) {
  Rows rows;
  rows.add({0.27, 4.27, 8.06, 8.27, 12.27, 16.26, 16.49, 20.27, 24.27}, {12.27, 20.27});
  rows.add({0.08, 4.08, 7.83, 8.08, 16.08, 16.3, 20.07, 24.07}, {20.07});
  rows.add({0.12, 4.12, 7.88, 8.12, 16.12, 16.39, 20.12, 24.11}, {4.12, 20.12});
  EXPECT_NEAR(rows.spacing().spacing_m, 4, 0.02);
}

/// Three rows of 24 m with a vine every 1.7 m and posts every 6 m, of which those 6 and 18 m from the start stand at
/// vines; `post_radius_m` is theirs, vines have 20–32 mm. Witnesses: the others.
struct HiddenPosts {
  std::vector<std::vector<PlacedStem>> stems;
  std::vector<std::vector<std::size_t>> witnesses;

  explicit HiddenPosts(double post_radius_m) {
    for (int row = 0; row < 3; ++row) {
      std::vector<PlacedStem> placed;
      std::vector<std::size_t> seen;
      const auto add = [&](double chainage_m, double radius_m, bool witness) {
        if (witness) seen.push_back(placed.size());
        placed.push_back({{}, chainage_m, 0});
        placed.back().stem.radius_m = radius_m;
      };
      add(0, 0.06, true);
      for (int vine = 0; vine < 14; ++vine) {
        if (vine == 7) add(12, 0.036, true);
        const double chainage_m = 0.92 + 1.7 * vine, radius_m = 0.020 + 0.001 * ((5 * vine + 7 * row) % 13);
        const bool at_post = std::abs(chainage_m - 6) < 0.3 || std::abs(chainage_m - 18) < 0.3;
        add(chainage_m, at_post ? post_radius_m : radius_m, false);
      }
      add(24, 0.06, true);
      stems.push_back(placed), witnesses.push_back(seen);
    }
  }
};

TEST(PostSpacing, PostsAtVinesShowByTheirFeet) {
  const HiddenPosts thick(0.037), thin(0.026);
  const auto spacing_m = [](const HiddenPosts& rows) {
    return usual_spacing(rows.stems, rows.witnesses, stem_thickness(rows.stems, rows.witnesses), 2.5, 15).spacing_m;
  };
  EXPECT_NEAR(spacing_m(thick), 6, 0.1);
  EXPECT_NEAR(spacing_m(thin), 12, 1e-9);
  EXPECT_EQ(parts_of_spacing(thick.stems, thick.witnesses, 12, 2.5), 2);
  EXPECT_EQ(parts_of_spacing(thin.stems, thin.witnesses, 12, 2.5), 1);
  EXPECT_EQ(parts_of_spacing(thick.stems, thick.witnesses, 12, 7), 1) << "panels of 6 m are too short";
}

// In a block of two short rows most of what every second place has are end posts, and these are taller than the rest.
TEST(PostSpacing, EndPostsDoNotMakeTheOthersLookLow) {
  Rows rows;
  rows.add({0, 10, 15, 20});
  rows.add({0, 20});
  for (auto& row : rows.stems) row.front().stem.top_m = row.back().stem.top_m = 1.9;
  EXPECT_NEAR(rows.spacing().spacing_m, 5, 1e-9);
}

/// Two rows of 20 m with a post every 5 m, and no trunks that could be seen. Foliage hides all of the posts but the end
/// ones and, in the second row, two: `witnesses`. Those halfway between the others have `halfway_radius_m`.
struct PostsAlone {
  std::vector<std::vector<PlacedStem>> stems;
  std::vector<std::vector<std::size_t>> witnesses{{0, 4}, {0, 1, 2, 4}};

  explicit PostsAlone(double halfway_radius_m) {
    for (int row = 0; row < 2; ++row) {
      std::vector<PlacedStem> placed;
      for (int k = 0; k < 5; ++k) {
        placed.push_back({{}, 5.0 * k, 0});
        placed.back().stem.radius_m = k % 4 == 0 ? 0.06 : 0.037;
      }
      placed[3].stem.radius_m = halfway_radius_m;
      if (row == 0) placed[1].stem.radius_m = halfway_radius_m;
      stems.push_back(placed);
    }
  }
};

TEST(PostSpacing, WithoutTrunksStemsAsThickAsPostsArePosts) {
  const PostsAlone posts(0.036), trees(0.028);
  EXPECT_EQ(parts_of_spacing(posts.stems, posts.witnesses, 10, 2.5), 2);
  EXPECT_EQ(parts_of_spacing(trees.stems, trees.witnesses, 10, 2.5), 1);
}

TEST(PostSpacing, WithoutTwoPostsInARowThereIsNone) {
  Rows rows;
  rows.add({3});
  rows.add({});
  EXPECT_TRUE(std::isnan(rows.spacing().spacing_m));
  EXPECT_FALSE(rows.spacing().regular);
}

}  // namespace
}  // namespace rayfield::density
