#include "rayfield/density/findings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/libdensity/season/seasons.h"

namespace rayfield::density {
namespace {

using testing::block_of;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using testing::value_of;

constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kCell_m = 0.125;

// One row of 12 m running east, canopy of 2 m²/m in a side view of 8 layers, but for the columns that the tests change.
class Gaps : public ::testing::Test {
 protected:
  Gaps() : block_(block_of({{value_of(12, 0.3, 0.02), value_of(12, 0.3, 0.02)}})) {
    block_.rows[0].centreline = {{100, 50}, {112, 50}};
    SectionProduct side{"side_view_row_1", "m2/m2", 1, Grid2<float>({0, 0.5}, kCell_m, 96, 8, 2.0F)};
    block_.scans[0].sections.push_back(side);
  }
  Grid2<float>& side() { return block_.scans[0].sections[0].grid; }
  void set(double from_m, double to_m, float density) {
    for (int x = static_cast<int>(from_m / kCell_m); x < static_cast<int>(to_m / kCell_m); ++x)
      for (int y = 0; y < side().ny; ++y) side().at(x, y) = density;
  }
  std::vector<RowGap> gaps(const GapOptions& options = {}) {
    const auto found = find_gaps(block_, 0, options);
    EXPECT_TRUE(found);
    return found.value_or(std::vector<RowGap>());
  }
  BlockProducts block_;
};

TEST_F(Gaps, AreFoundWithTheirPlaceAndThePanelThatHoldsTheirMiddle) {
  set(7, 8.5, 0.2F);  // a tenth of what is usual
  const auto found = gaps();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].row_number, 1);
  EXPECT_DOUBLE_EQ(found[0].start_m, 7);
  EXPECT_DOUBLE_EQ(found[0].end_m, 8.5);
  EXPECT_NEAR(found[0].position.x(), 107.75, 1e-9);
  EXPECT_NEAR(found[0].position.y(), 50, 1e-9);
  EXPECT_EQ(found[0].panel_number, 2) << "panel 2 runs from 6 to 12 m";
}

TEST_F(Gaps, HalfAMetreIsAGapAndLessIsNone) {
  set(2, 2.5, 0);
  set(5, 5.375, 0);
  const auto found = gaps();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_DOUBLE_EQ(found[0].start_m, 2);
  EXPECT_THAT(gaps({.min_length_m = 0.375}), SizeIs(2));
}

TEST_F(Gaps, WhatIsThinButAboveTheShareIsNone) {
  set(2, 4, 0.5F);  // a quarter of what is usual
  EXPECT_THAT(gaps(), IsEmpty());
  EXPECT_THAT(gaps({.share_of_median = 0.3}), SizeIs(1));
}

TEST_F(Gaps, WhatWasNotSeenIsNoGapAndEndsOne) {
  set(1, 3, kUnseen);
  EXPECT_THAT(gaps(), IsEmpty());
  set(6, 7, 0);
  set(6.375, 6.625, kUnseen);
  EXPECT_THAT(gaps(), IsEmpty()) << "two stretches of 0.375 m are no gap of 1 m";
}

TEST_F(Gaps, APostDoesNotPartAGap) {
  set(3, 4.5, 0);
  set(3.625, 3.875, 4.0F);
  EXPECT_THAT(gaps(), SizeIs(2));
  PostProduct post;
  post.row_number = 1, post.chainage_m = 3.75;
  block_.posts.push_back(post);
  const auto found = gaps();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_DOUBLE_EQ(found[0].start_m, 3);
  EXPECT_DOUBLE_EQ(found[0].end_m, 4.5);
}

TEST_F(Gaps, BareVinesHaveNone) {
  set(0, 12, 0.3F);  // 0.3 m²/m
  set(4, 6, 0);
  EXPECT_THAT(gaps(), IsEmpty());
  EXPECT_THAT(gaps({.min_canopy_per_m = 0.2}), SizeIs(1));
}

TEST_F(Gaps, EndWithTheRow) {
  side().origin.x() = -1;  // the section overhangs the row
  block_.rows[0].length_m = 9;
  set(0, 2, 0);     // −1 to 1 m
  set(9.5, 12, 0);  // 8.5 to 11 m
  const auto found = gaps();
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_DOUBLE_EQ(found[0].start_m, 0);
  EXPECT_DOUBLE_EQ(found[1].end_m, 9);
}

TEST_F(Gaps, RefuseOptionsAndScansThatAreNone) {
  EXPECT_EQ(find_gaps(block_, 0, {.share_of_median = 2}).error().code, ErrorCode::usage);
  EXPECT_EQ(find_gaps(block_, 1, {}).error().code, ErrorCode::usage);
}

TEST(GapAmong, HalfOfItsLengthMustBeGapThere) {
  const RowGap gap{1, 2, 4};
  EXPECT_TRUE(is_gap_among(gap, std::vector{RowGap{1, 3, 6}}));
  EXPECT_FALSE(is_gap_among(gap, std::vector{RowGap{1, 3.25, 6}}));
  EXPECT_TRUE(is_gap_among(gap, std::vector{RowGap{1, 1, 2.5}, RowGap{1, 3.5, 6}}));
  EXPECT_FALSE(is_gap_among(gap, std::vector{RowGap{2, 2, 4}})) << "another row";
}

// Panels of 6 m with these leaf areas per metre, three to a row.
BlockProducts block_with(const std::vector<double>& per_m) {
  std::vector<PanelValue> values;
  for (const double v : per_m) {
    values.push_back(value_of(6 * v, 0.3, 0.02));
    values.back().leaf_area_per_m = v;
  }
  return block_of({values}, 3);
}

TEST(PanelClasses, AreEquallyLargePartsFromTheWeakest) {
  const BlockProducts block = block_with({1.0, 2.0, 0.5, 3.0, 2.5, 1.5});
  EXPECT_THAT(panel_classes(block, 0, 3), ElementsAre(0, 1, 0, 2, 2, 1));
}

TEST(PanelClasses, HaveNoPlaceForWhatWasNotSeenAndOneForEqualValues) {
  const BlockProducts block = block_with({1.0, kNaN, 1.0, 1.0, 4.0, kNaN});
  EXPECT_THAT(panel_classes(block, 0, 2), ElementsAre(0, -1, 0, 0, 1, -1));
}

TEST(WeakStretches, JoinNeighboursOfARowAndPutTheWeakestFirst) {
  const BlockProducts block = block_with({0.6, 0.8, 3.0, 0.5, 2.0, 0.9});
  const auto found = weak_stretches(block, 0, std::vector{0, 0, 1, 0, 1, 0});
  ASSERT_THAT(found, SizeIs(3));
  EXPECT_EQ(found[0].row_number, 2);
  EXPECT_EQ(found[0].first_panel, 1);
  EXPECT_NEAR(found[0].leaf_area_per_m, 0.5, 1e-12);
  EXPECT_EQ(found[1].row_number, 1);
  EXPECT_EQ(found[1].first_panel, 1);
  EXPECT_EQ(found[1].last_panel, 2);
  EXPECT_DOUBLE_EQ(found[1].start_m, 0);
  EXPECT_DOUBLE_EQ(found[1].end_m, 12);
  EXPECT_NEAR(found[1].leaf_area_per_m, 0.7, 1e-12) << "of both together";
  EXPECT_EQ(found[2].first_panel, 3);
}

}  // namespace
}  // namespace rayfield::density
