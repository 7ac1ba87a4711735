#include "libdensity/posts/posts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libdensity/posts/stem_accumulator.h"
#include "libdensity/registry/layout_arrays.h"
#include "tests/libdensity/scene.h"

namespace rayfield::density {
namespace {

using testing::BlockShape;
using testing::Scene;

constexpr double kPanel = 6.0;

// One row with posts every six metres and vines every 1.5 m, full of leaves from the cordon to the posts' tops.
struct Trellis {
  BlockShape block;
  std::vector<Eigen::Vector2d> posts;
  Trellis() { block.azimuth_deg = 33, block.length_m = 30; }

  void add_to(Scene& scene, const std::vector<int>& hidden = {}, double radius_m = 0.05,
              const Eigen::Vector2d& lean = Eigen::Vector2d::Zero()) {
    scene.add_ground({500015, 6100025}, {500065, 6100080}, 40, 0.015);
    for (int i = 0; i <= 5; ++i) {
      const Eigen::Vector2d p = block.at(i * kPanel / 30, scene.normal(0.015));
      posts.push_back(p);
      if (std::find(hidden.begin(), hidden.end(), i) == hidden.end()) scene.add_cylinder(p, radius_m, 1.8, 280, lean);
    }
    for (double s = 0.75; s < 30; s += 1.5) scene.add_cylinder(block.at(s / 30, scene.normal(0.03)), 0.022, 0.95, 200);
    scene.add_canopy(block, 0, 0, 1, 1200, 0.13, 0.9, 1.6);
    scene.drive_lanes(block, {1.3, -1.3});
  }
};

struct Placed {
  testing::Found found;
  RowLayout layout;
  PostReport report;
};

Placed place(const Scene& scene, const PostOptions& options = {}) {
  Placed out{testing::find_rows_in(scene), {}, {}};
  out.layout = out.found.rows.layout;
  const auto stems = testing::stems_of(out.found.tiles, out.layout, out.found.ground);
  out.report = place_posts(out.layout, stems, options).value();
  return out;
}

TEST(Posts, AreFoundToACentimetreInFullLeafAndTrunksAreNotTakenForThem) {
  Scene scene(31);
  Trellis trellis;
  trellis.add_to(scene);
  const Placed placed = place(scene);
  ASSERT_EQ(placed.layout.posts.size(), 6U);
  EXPECT_EQ(placed.report.detected, 6);
  EXPECT_NEAR(placed.report.panel_length_m, kPanel, 0.03);
  for (const Post& post : placed.layout.posts) {
    double nearest = 1e9;
    for (const auto& p : trellis.posts) nearest = std::min(nearest, (p - post.position).norm());
    EXPECT_LT(nearest, 0.02);
    EXPECT_NEAR(post.radius_m, 0.05, 0.01);
    EXPECT_NEAR(post.height_m, 1.8, 0.1);
    EXPECT_LT(post.lean.norm(), 0.03);
  }
}

TEST(Posts, TrunksAreGivenWithTheirTops) {
  Scene scene(32);
  Trellis trellis;
  trellis.add_to(scene);
  const Placed placed = place(scene);
  EXPECT_GE(placed.layout.trunks.size(), 18U);
  EXPECT_LE(placed.layout.trunks.size(), 20U);
  int near_top = 0;
  for (const Trunk& trunk : placed.layout.trunks) {
    EXPECT_NEAR(std::remainder(trunk.chainage_m - 0.75, 1.5), 0, 0.06);
    EXPECT_LT(trunk.radius_m, 0.04);
    if (std::abs(trunk.top_m - 0.95) < 0.2) ++near_top;
  }
  EXPECT_GT(2 * near_top, static_cast<int>(placed.layout.trunks.size()));
}

TEST(Posts, BentTrunksAreAsThickAsTheyAreAndEndWhereMostDo) {
  constexpr double kRadius = 0.022, kTop = 0.9;
  Scene scene(42);
  Trellis trellis;
  trellis.block.length_m = 30;
  scene.add_ground({500015, 6100025}, {500065, 6100080}, 40, 0.015);
  for (int i = 0; i <= 5; ++i) scene.add_cylinder(trellis.block.at(i * kPanel / 30, 0), 0.05, 1.8, 280);
  int vine = 0;
  for (double s = 0.75; s < 30; s += 1.5, ++vine) {
    // A trunk that sways by two to four centimetres between its foot, two joints and its head; every third has a cane
    // on its axis.
    const Eigen::Vector2d foot = trellis.block.at(s / 30, 0);
    Eigen::Vector2d joint[4];
    for (Eigen::Vector2d& j : joint) j = foot + Eigen::Vector2d(scene.normal(0.025), scene.normal(0.025));
    for (int i = 0; i < 300; ++i) {
      const double h = scene.uniform(0, kTop), at = h / kTop * 3, share = at - std::floor(at);
      const auto k = static_cast<std::size_t>(at);
      const double angle = scene.uniform(0, 2 * M_PI), r = kRadius + scene.normal(0.01);
      const Eigen::Vector2d p = joint[k] + share * (joint[std::min<std::size_t>(k + 1, 3)] - joint[k]) +
                                r * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      scene.add_point({p.x(), p.y(), 100 + h});
    }
    if (vine % 3 == 0) scene.add_cylinder(joint[3], 0.01, 1.5, 150);
  }
  scene.add_canopy(trellis.block, 0, 0, 1, 150, 0.13, 0.9, 1.6);
  scene.drive_lanes(trellis.block, {1.3, -1.3});
  const Placed placed = place(scene);
  ASSERT_GE(placed.layout.trunks.size(), 18U);
  double radius = 0;
  for (const Trunk& trunk : placed.layout.trunks) {
    radius += trunk.radius_m / static_cast<double>(placed.layout.trunks.size());
    EXPECT_LT(trunk.top_m, kTop + 0.12);
    EXPECT_GT(trunk.top_m, kTop - 0.25);
  }
  EXPECT_NEAR(radius, kRadius, 0.0025);
}

TEST(Posts, ThatCannotBeSeenAreInferredFromTheRegularSpacing) {
  Scene scene(33);
  Trellis trellis;
  trellis.add_to(scene, {2});
  const Placed placed = place(scene);
  ASSERT_EQ(placed.layout.posts.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(placed.layout.posts[i].detected, i != 2);
    EXPECT_NEAR(placed.layout.posts[i].chainage_m, static_cast<double>(i) * kPanel, 0.06);
  }
}

TEST(Posts, TellTheirLean) {
  Scene scene(34);
  Trellis trellis;
  const Eigen::Vector2d lean(0.04, -0.02);
  trellis.add_to(scene, {}, 0.05, lean);
  const Placed placed = place(scene);
  ASSERT_EQ(placed.layout.posts.size(), 6U);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Post& post : placed.layout.posts) mean += post.lean / 6;
  EXPECT_NEAR(mean.x(), lean.x(), 0.015);
  EXPECT_NEAR(mean.y(), lean.y(), 0.015);
}

TEST(Posts, EndTheRowAndBoundThePanels) {
  Scene scene(35);
  Trellis trellis;
  trellis.add_to(scene);
  const Placed placed = place(scene);
  ASSERT_EQ(placed.layout.rows.size(), 1U);
  const Row& row = placed.layout.rows[0];
  EXPECT_LT((row.centreline.front() - trellis.posts.front()).norm(), 0.03);
  EXPECT_LT((row.centreline.back() - trellis.posts.back()).norm(), 0.03);
  ASSERT_EQ(placed.layout.panels.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(placed.layout.panels[i].number, static_cast<int>(i) + 1);
    EXPECT_NEAR(placed.layout.panels[i].end_m - placed.layout.panels[i].start_m, kPanel, 0.06);
    EXPECT_EQ(placed.layout.panels[i].start_m, i > 0 ? placed.layout.panels[i - 1].end_m : 0.0);
  }
  EXPECT_EQ(placed.layout.panels.front().start_m, 0);
  EXPECT_NEAR(placed.layout.panels.back().end_m, row.length_m(), 1e-9);
}

TEST(Posts, AreNotInventedInARowWithoutAny) {
  Scene scene(36);
  Trellis trellis;
  trellis.add_to(scene, {0, 1, 2, 3, 4, 5});
  const Placed placed = place(scene);
  EXPECT_EQ(placed.report.detected, 0);
  EXPECT_TRUE(placed.layout.posts.empty());
  ASSERT_EQ(placed.layout.panels.size(), 1U);  // the whole row
  EXPECT_NEAR(placed.layout.panels[0].end_m, 30, 0.5);
  EXPECT_FALSE(placed.report.warnings.empty());
}

TEST(Posts, OnTheBorderOfTwoTilesAreFoundOnce) {
  Scene scene(37);
  BlockShape block;
  block.start = {500025.0, 6100010}, block.azimuth_deg = 0, block.length_m = 24;  // along x = 500025, a tile border
  scene.add_ground({500005, 6100000}, {500045, 6100045}, 40, 0.015);
  for (int i = 0; i <= 4; ++i) scene.add_cylinder(block.at(i / 4.0, 0), 0.05, 1.8, 280);
  scene.add_canopy(block, 0, 0, 1, 1000, 0.13, 0.9, 1.6);
  scene.drive_lanes(block, {1.3, -1.3});
  const Placed placed = place(scene);
  EXPECT_EQ(placed.layout.posts.size(), 5U);
  EXPECT_EQ(placed.report.inferred, 0);
}

Stem stem_at(int row, const Eigen::Vector2d& position, double radius_m, double top_m, double upper_share) {
  Stem stem;
  stem.row = row, stem.position = position, stem.radius_m = radius_m, stem.top_m = top_m;
  stem.contrast = 100, stem.upper_share = upper_share;
  return stem;
}

// Whether i is listed for a row, counted from one.
bool is_in(const std::vector<std::vector<int>>& rows, int row, int i) {
  const std::vector<int>& listed = rows[static_cast<std::size_t>(row - 1)];
  return std::find(listed.begin(), listed.end(), i) != listed.end();
}

// Posts at every seventh metre, some of them lost in the leaves, and vines at every 1.75 m of which some look like
// posts.
TEST(Posts, AreToldFromTallVinesByTheSpacingOfTheBlock) {
  constexpr double kLength = 42, kSpacing = 7, kVine = 1.75;
  const std::vector<std::vector<int>> lost = {{2, 3, 4}, {2, 4}, {1, 3, 4, 5}};
  const std::vector<std::vector<int>> tall = {{3, 14}, {2, 4, 14}, {}};
  RowLayout layout;
  std::vector<Stem> stems;
  for (int row = 1; row <= 3; ++row) {
    const double y = 2.5 * row;
    layout.rows.push_back({row, {{0, y}, {kLength, y}}});
    const auto add = [&](double x, double radius_m, double top_m, double upper_share) {
      stems.push_back(stem_at(row, {x, y}, radius_m, top_m, upper_share));
    };
    for (int i = 0; i <= 6; ++i) add(i * kSpacing, 0.035, 1.8, is_in(lost, row, i) ? 0.0 : 1.2);
    for (int i = 0; i < 24; ++i) add((i + 0.5) * kVine, 0.025, 1.0, is_in(tall, row, i) ? 1.1 : 0.0);
  }
  ASSERT_TRUE(place_posts(layout, stems, PostOptions()));
  ASSERT_EQ(layout.posts.size(), 21U);
  EXPECT_EQ(layout.panels.size(), 18U);
  for (const Post& post : layout.posts)
    EXPECT_NEAR(post.chainage_m, kSpacing * std::round(post.chainage_m / kSpacing), 0.01);
}

// Summer: of the line posts two stick out of the canopy, and four vines do by chance. A third of the row explains them
// nearly as well as a quarter; the posts that stand between two vines decide.
TEST(Posts, OfADenseCanopyAreFoundByTheVinesBesideThem) {
  constexpr double kLength = 26, kSpacing = 6.5, kVine = kSpacing / 3.5;
  const std::vector<std::vector<int>> seen = {{0, 3, 4}, {0, 4}, {0, 1, 4}};
  const std::vector<std::vector<int>> tall = {{4, 6, 13}, {7}, {}};
  RowLayout layout;
  std::vector<Stem> stems;
  for (int row = 1; row <= 3; ++row) {
    const double y = 3.0 * row;
    layout.rows.push_back({row, {{0, y}, {kLength, y}}});
    const auto add = [&](double x, double radius_m, double top_m, double upper_share) {
      stems.push_back(stem_at(row, {x, y}, radius_m, top_m, upper_share));
    };
    for (int i = 0; i <= 4; ++i) add(i * kSpacing, 0.035, 1.8, is_in(seen, row, i) ? 1.1 : 0.0);
    for (int i = 0; i < 14; ++i)
      if (i != 3 && i != 10)
        add((i + 0.5) * kVine, 0.028, 1.0, is_in(tall, row, i) ? 1.2 : 0.0);  // those two are at posts
  }
  ASSERT_TRUE(place_posts(layout, stems, PostOptions()));
  ASSERT_EQ(layout.panels.size(), 12U);
  for (const Panel& panel : layout.panels) EXPECT_NEAR(panel.end_m - panel.start_m, kSpacing, 0.01);
}

// A wall of leaves that beams as wide as leaves hardly enter: feet are all that is seen but of the strainers, some
// vines look tall, and every other post has taken a vine's place, so that no two stems stand closer than vines do.
TEST(Posts, OfWhichOnlyFeetAreSeenAreToldByTheirThickness) {
  constexpr double kLength = 24, kSpacing = 6, kVine = 1.7;
  const std::vector<std::vector<int>> tall = {{1}, {2, 8}, {8}};
  const std::vector<double> vine_radii_mm = {24, 27, 32, 28, 26, 25, 30, 27, 23, 33, 27, 24, 29, 22};
  RowLayout layout;
  std::vector<Stem> stems;
  for (int row = 1; row <= 3; ++row) {
    const double y = 3.0 * row;
    layout.rows.push_back({row, {{0, y}, {kLength, y}}});
    for (int i = 0; i <= 4; ++i) {
      const bool strainer = i == 0 || i == 4;
      const double radius_m = strainer ? 0.058 : 0.037 + 0.002 * ((i + row) % 4);
      stems.push_back(stem_at(row, {i * kSpacing, y}, radius_m, strainer ? 1.9 : 0.9, strainer ? 1.1 : 0.0));
      if (strainer) stems.back().solidity = 50;
    }
    for (int i = 0; i < 14; ++i) {
      const double x = 0.85 + i * kVine;
      if (std::abs(x - 6) < 0.3 || std::abs(x - 18) < 0.3) continue;
      const double radius_m = 1e-3 * vine_radii_mm[static_cast<std::size_t>(i + 5 * row) % vine_radii_mm.size()];
      stems.push_back(stem_at(row, {x, y}, radius_m, 0.9, is_in(tall, row, i) ? 1.3 : 0.0));
    }
  }
  const auto report = place_posts(layout, stems, PostOptions());
  ASSERT_TRUE(report);
  EXPECT_EQ(report->detected, 15);
  ASSERT_EQ(layout.panels.size(), 12U);
  for (const Panel& panel : layout.panels) EXPECT_NEAR(panel.end_m - panel.start_m, kSpacing, 0.01);
}

TEST(Panels, OfGivenLengthLetAShortRestJoinItsNeighbour) {
  RowLayout layout;
  for (const double length : {20.0, 22.9, 23.6, 3.0}) {
    Row row;
    row.number = static_cast<int>(layout.rows.size()) + 1;
    row.centreline = {{0, 0}, {length, 0}};
    layout.rows.push_back(row);
  }
  make_panels(layout, 5.0);
  std::vector<int> count(5, 0);
  double last_of_second = 0;
  for (const Panel& p : layout.panels) {
    ++count[static_cast<std::size_t>(p.row)];
    if (p.row == 3) last_of_second = p.end_m - p.start_m;
  }
  EXPECT_EQ(count, (std::vector<int>{0, 4, 5, 5, 1}));  // 22.9 = 4×5 + 2.9, 23.6 = 4×5 + 3.6, 3 = one short panel
  EXPECT_NEAR(last_of_second, 3.6, 1e-9);
}

TEST(Layout, SurvivesStorage) {
  Scene scene(38);
  Trellis trellis;
  trellis.add_to(scene, {3});
  const Placed placed = place(scene);
  const tile::ArraySet stored = layout_to_arrays(placed.layout);
  const auto back = layout_from_arrays(stored);
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(layout_to_arrays(*back).columns, stored.columns);
  EXPECT_TRUE(std::isnan(back->spacing_m));
  EXPECT_EQ(back->posts.size(), placed.layout.posts.size());
  EXPECT_EQ(back->trunks.size(), placed.layout.trunks.size());
  ASSERT_EQ(back->rows.size(), 1U);
  EXPECT_EQ(back->rows[0].centreline, placed.layout.rows[0].centreline);

  tile::ArraySet wrong = stored;
  std::get<std::vector<std::int32_t>>(wrong.columns["row_vertices"])[0] = 1 << 30;
  EXPECT_EQ(layout_from_arrays(wrong).error().code, ErrorCode::damaged);
  wrong = stored;
  wrong.columns.erase("post_radius_m");
  EXPECT_EQ(layout_from_arrays(wrong).error().code, ErrorCode::damaged);
}

TEST(Stems, AreTheSameHoweverTheSegmentsAreSplit) {
  Scene scene(39);
  Trellis trellis;
  trellis.add_to(scene);
  const auto found = testing::find_rows_in(scene);
  const auto& [index, batch] =
      *std::max_element(found.tiles.begin(), found.tiles.end(),
                        [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  StemAccumulator whole({index, testing::kTile}, found.rows.layout, found.ground, {});
  const tile::HitBatch hits = testing::hits_of(batch);
  whole.add(hits);
  StemAccumulator odd = StemAccumulator({index, testing::kTile}, found.rows.layout, found.ground, {}), even = odd;
  for (std::size_t i = 0; i < hits.size(); ++i) (i % 2 ? odd : even).add({{hits.end[i]}, {hits.flags[i]}});
  odd.merge(even);
  EXPECT_EQ(odd.finish(), whole.finish());
  EXPECT_FALSE(whole.finish().empty());
}

}  // namespace
}  // namespace rayfield::density
