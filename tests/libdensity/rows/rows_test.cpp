#include "libdensity/rows/rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/libdensity/scene.h"

namespace rayfield::density {
namespace {

using testing::BlockShape;
using testing::Scene;

constexpr double kSpacing = 2.6;

// Rows at across = 0, −spacing … with lanes on both sides of each, seen as canopy points with a gap of missing vines.
void add_block(Scene& scene, const BlockShape& block, int rows) {
  std::vector<double> lanes;
  for (int i = 0; i <= rows; ++i) lanes.push_back(kSpacing / 2 - i * kSpacing);
  for (int i = 0; i < rows; ++i) {
    scene.add_canopy(block, -i * kSpacing, 0, 0.45, 500);
    scene.add_canopy(block, -i * kSpacing, 0.55, 1, 500);  // 3 m of missing vines
  }
  scene.drive_lanes(block, lanes);
}

void add_ground_around(Scene& scene) { scene.add_ground({499995, 6100005}, {500072, 6100085}, 30, 0.015); }

// Greatest distance of a row's vertices from the true line.
double worst_offset(const Row& row, const BlockShape& block, double across_m) {
  double worst = 0;
  for (const auto& p : row.centreline) {
    double best = 1e9;
    for (int i = -200; i <= 2200; ++i) best = std::min(best, (block.at(i / 2000.0, across_m) - p).norm());
    worst = std::max(worst, best);
  }
  return worst;
}

double worst_end(const Row& row, const BlockShape& block, double across_m) {
  const auto nearest = [&](double share) {
    const Eigen::Vector2d end = block.at(share, across_m);
    return std::min((row.centreline.front() - end).norm(), (row.centreline.back() - end).norm());
  };
  return std::max(nearest(0), nearest(1));
}

struct Case {
  double azimuth_deg, radius_m;
};

class RowsOfAnyShape : public ::testing::TestWithParam<Case> {};

TEST_P(RowsOfAnyShape, AreAllFoundAndNoneInvented) {
  Scene scene(21, [](double x, double y) { return 100 + 0.05 * (x - 500000) - 0.03 * (y - 6100000); });
  BlockShape block;
  block.azimuth_deg = GetParam().azimuth_deg, block.radius_m = GetParam().radius_m;
  add_ground_around(scene);
  add_block(scene, block, 4);
  const auto found = testing::find_rows_in(scene);
  ASSERT_EQ(found.rows.layout.rows.size(), 4U);
  EXPECT_NEAR(found.rows.layout.spacing_m, kSpacing, 0.03);
  std::vector<int> seen(4, 0);
  for (const Row& row : found.rows.layout.rows)
    for (int i = 0; i < 4; ++i)
      if (worst_offset(row, block, -i * kSpacing) < 0.10) {
        ++seen[static_cast<std::size_t>(i)];
        EXPECT_LT(worst_end(row, block, -i * kSpacing), 0.35);
        EXPECT_TRUE(row.seen_from_left && row.seen_from_right);
      }
  EXPECT_EQ(seen, std::vector<int>(4, 1));
}

INSTANTIATE_TEST_SUITE_P(Shapes, RowsOfAnyShape,
                         ::testing::Values(Case{0, 0}, Case{24, 0}, Case{90, 0}, Case{137, 0}, Case{45, 60},
                                           Case{10, 90}),
                         [](const auto& p) {
                           return "azimuth_" + std::to_string(static_cast<int>(p.param.azimuth_deg)) + "_radius_" +
                                  std::to_string(static_cast<int>(p.param.radius_m));
                         });

TEST(Rows, ASingleRowHasNoSpacing) {
  Scene scene(22);
  BlockShape block;
  add_ground_around(scene);
  add_block(scene, block, 1);
  const auto found = testing::find_rows_in(scene);
  ASSERT_EQ(found.rows.layout.rows.size(), 1U);
  EXPECT_TRUE(std::isnan(found.rows.layout.spacing_m));
  EXPECT_LT(worst_offset(found.rows.layout.rows[0], block, 0), 0.06);
}

TEST(Rows, AnOuterRowDrivenOnOneSideIsFoundAndMarkedSo) {
  Scene scene(23);
  BlockShape block;  // rows at 0 and −spacing, one lane between them
  add_ground_around(scene);
  scene.add_canopy(block, 0, 0, 1, 500);
  scene.add_canopy(block, -kSpacing, 0, 1, 500);
  scene.drive_lanes(block, {-kSpacing / 2});
  const auto found = testing::find_rows_in(scene);
  ASSERT_EQ(found.rows.layout.rows.size(), 2U);
  EXPECT_FALSE(found.rows.layout.rows[0].seen_from_left);
  EXPECT_TRUE(found.rows.layout.rows[0].seen_from_right);
  EXPECT_TRUE(found.rows.layout.rows[1].seen_from_left);
  EXPECT_FALSE(found.rows.layout.rows[1].seen_from_right);
}

TEST(Rows, ALaneOutsideTheBlockAFenceTreesAndAHeadlandMakeNoRow) {
  Scene scene(24);
  BlockShape block;
  add_ground_around(scene);
  for (int i = 0; i < 3; ++i) scene.add_canopy(block, -i * kSpacing, 0, 1, 500);
  // Lanes beside every row, then two lanes further out on the left: between them a fence, beyond them trees.
  scene.drive_lanes(block, {-2.5 * kSpacing, -1.5 * kSpacing, -0.5 * kSpacing, 0.5 * kSpacing, 1.5 * kSpacing});
  for (int post = 0; post <= 10; ++post) scene.add_cylinder(block.at(post / 10.0, kSpacing), 0.05, 1.2, 300);
  scene.add_canopy(block, kSpacing, 0, 1, 12, 0.01, 0.9, 1.2);  // wires: a few hits per metre
  for (double at : {0.1, 0.5, 0.9}) {                           // crowns of 5 m, from 1.5 m up to 8 m
    for (int i = 0; i < 12000; ++i) {
      const Eigen::Vector2d p =
          block.at(at, 2 * kSpacing + 1.3) + Eigen::Vector2d(scene.normal(1.2), scene.normal(1.2));
      scene.add_point({p.x(), p.y(), 100 + scene.uniform(1.5, 8)});
    }
  }
  // A straight drive along the headland, 2 m before the rows' ends.
  scene.add_drive({block.at(-2.0 / 30, 8), block.at(-2.0 / 30, -14)});
  const auto found = testing::find_rows_in(scene);
  ASSERT_EQ(found.rows.layout.rows.size(), 3U);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(worst_offset(found.rows.layout.rows[static_cast<std::size_t>(i)], block, -i * kSpacing), 0.08);
}

TEST(Rows, OfTwoDirectionsAreTwoBlocksNumberedOneAfterTheOther) {
  Scene scene(25);
  add_ground_around(scene);
  BlockShape north, east;
  north.start = {500008, 6100015}, north.azimuth_deg = 0, north.length_m = 25;
  east.start = {500030, 6100072}, east.azimuth_deg = 90, east.length_m = 25;
  add_block(scene, north, 2);
  add_block(scene, east, 2);
  const auto found = testing::find_rows_in(scene);
  ASSERT_EQ(found.rows.layout.rows.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const Row& row = found.rows.layout.rows[i];
    EXPECT_EQ(row.number, static_cast<int>(i) + 1);
    const Eigen::Vector2d d = (row.centreline.back() - row.centreline.front()).normalized();
    EXPECT_GT(i < 2 ? d.y() : d.x(), 0.99);
  }
}

TEST(Rows, NothingToFindIsNoError) {
  Scene bare(26);
  add_ground_around(bare);
  bare.drive_lanes(BlockShape{}, {0, 2.5});
  EXPECT_TRUE(testing::find_rows_in(bare).rows.layout.rows.empty());
  CanopyMap nothing(25);
  const auto none = find_rows({}, nothing, {});
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->layout.rows.empty());
}

TEST(RowNumbers, CountFromTheLeftOfNorthOrOfEastWhateverTheOrderAndDirectionOfTheInput) {
  for (const double azimuth : {20.0, 200.0, 85.0, 265.0, -60.0}) {
    BlockShape block;
    block.azimuth_deg = azimuth;
    RowLayout layout;
    for (int i : {2, 0, 3, 1}) {
      Row row;
      for (int k = 0; k <= 20; ++k) row.centreline.push_back(block.at(k / 20.0, -i * kSpacing));
      if (i % 2 == 1) {
        std::reverse(row.centreline.begin(), row.centreline.end());
        row.seen_from_left = false;  // of the reversed line
      }
      layout.rows.push_back(row);
    }
    number_rows(layout);
    const bool easterly = std::abs(std::cos(azimuth * M_PI / 180)) < std::sin(15 * M_PI / 180);
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d d = layout.rows[i].centreline.back() - layout.rows[i].centreline.front();
      EXPECT_GT(easterly ? d.x() : d.y(), 0);
      EXPECT_EQ(layout.rows[i].number, static_cast<int>(i) + 1);
      if (i == 0) continue;
      const Eigen::Vector2d step = layout.rows[i].centreline.front() - layout.rows[i - 1].centreline.front();
      EXPECT_LT(d.x() * step.y() - d.y() * step.x(), 0);  // to the right
    }
    EXPECT_NEAR(layout.spacing_m, kSpacing, 1e-6);
  }
}

}  // namespace
}  // namespace rayfield::density
