#include "libdensity/registry/survey_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/libdensity/layout_support.h"

namespace rayfield::density {
namespace {

using namespace testing;
using ::testing::HasSubstr;

SurveyedRow line(std::optional<int> number, double east_m, const std::string& name = {}) {
  return {number, name, {kCorner + Eigen::Vector2d(east_m, 0), kCorner + Eigen::Vector2d(east_m, 24)}};
}

SurveyedPost post(std::optional<int> row, double east_m, double north_m) {
  return {row, "", kCorner + Eigen::Vector2d(east_m, north_m), {}, {}};
}

void expect_refused(const SurveyedBlock& survey, const std::string& why) {
  const auto layout = layout_of_survey(survey);
  ASSERT_FALSE(layout) << why;
  EXPECT_EQ(layout.error().code, ErrorCode::bad_input);
  EXPECT_THAT(layout.error().line(), HasSubstr(why));
  EXPECT_FALSE(layout.error().next.empty());
}

TEST(SurveyLayout, LinesAreRowsInTheBlocksOrderWithTheFarmsNumbers) {
  // Numbered from the east, drawn from the north.
  SurveyedBlock survey{"rows.gpkg", {line(101, 6, "last"), line(102, 3), line(103, 0)}, {}};
  for (SurveyedRow& row : survey.rows) std::reverse(row.line.begin(), row.line.end());
  const auto layout = layout_of_survey(survey);
  ASSERT_TRUE(layout) << layout.error().line();
  ASSERT_EQ(layout->rows.size(), 3U);
  EXPECT_EQ(layout->rows[0].number, 1);
  EXPECT_EQ(layout->rows[0].shown_number(), 103);
  EXPECT_EQ(layout->rows[2].shown_number(), 101);
  EXPECT_EQ(layout->rows[2].name, "last");
  EXPECT_NEAR(layout->spacing_m, 3, 1e-9);
  EXPECT_NEAR((layout->rows[0].centreline.front() - kCorner).norm(), 0, 1e-9);
  EXPECT_EQ(layout->rows[0].identity.source, "surveyed");
}

TEST(SurveyLayout, PostsAloneMakeRowsWhateverTheirOrder) {
  SurveyedBlock survey{"posts.csv", {}, {}};
  for (const double north : {12.0, 0.0, 24.0, 6.0, 18.0})
    for (int row = 1; row <= 2; ++row) survey.posts.push_back(post(row, 3.0 * row, north));
  survey.posts[0].diameter_m = 0.12, survey.posts[0].height_m = 2.1;
  const auto layout = layout_of_survey(survey);
  ASSERT_TRUE(layout) << layout.error().line();
  ASSERT_EQ(layout->rows.size(), 2U);
  EXPECT_NEAR(layout->rows[0].length_m(), 24, 1e-9);
  ASSERT_EQ(layout->posts.size(), 10U);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(layout->posts[static_cast<std::size_t>(i)].row, 1);
    EXPECT_NEAR(layout->posts[static_cast<std::size_t>(i)].chainage_m, 6 * i, 1e-9);
    EXPECT_FALSE(layout->posts[static_cast<std::size_t>(i)].detected) << "no scan has shown it";
  }
  EXPECT_NEAR(layout->posts[2].radius_m, 0.06, 1e-12);
  EXPECT_NEAR(layout->posts[2].height_m, 2.1, 1e-12);
}

TEST(SurveyLayout, PostsWithoutARowBelongToTheNearestLine) {
  SurveyedBlock survey{"both.gpkg", {line(1, 0), line(2, 3)}, {post({}, 0.1, 6), post({}, 2.9, 12)}};
  const auto layout = layout_of_survey(survey);
  ASSERT_TRUE(layout) << layout.error().line();
  ASSERT_EQ(layout->posts.size(), 2U);
  EXPECT_EQ(layout->posts[0].row, 1);
  EXPECT_EQ(layout->posts[1].row, 2);
  EXPECT_NEAR(layout->posts[0].across_m, -0.1, 1e-9);
}

TEST(SurveyLayout, RowsWithoutNumberGetThoseThatAreFree) {
  const auto layout = layout_of_survey({"rows.gpkg", {line({}, 0), line(1, 3), line({}, 6)}, {}});
  ASSERT_TRUE(layout) << layout.error().line();
  EXPECT_EQ(layout->rows[0].shown_number(), 2);
  EXPECT_EQ(layout->rows[1].shown_number(), 1);
  EXPECT_EQ(layout->rows[2].shown_number(), 3);
}

TEST(SurveyLayout, RefusesWhatMakesNoRows) {
  expect_refused({"one.csv", {}, {post(1, 0, 0)}}, "it holds one post");
  expect_refused({"a.csv", {}, {post(1, 0, 0), post(1, 0, 6), post(2, 3, 0)}}, "row 2 has one post");
  expect_refused({"a.csv", {}, {post({}, 0, 0), post({}, 0, 6)}}, "belongs to no row");
  expect_refused({"a.csv", {}, {post(1, 0, 0), post(1, 0, 0)}}, "stand in one place");
  SurveyedRow point = line(4, 0);
  point.line.back() = point.line.front();
  expect_refused({"a.gpkg", {point}, {}}, "row 4 is a point, not a line");
  expect_refused({"a.gpkg", {line(1, 0), line(1, 3)}, {}}, "two rows have the number 1");
  expect_refused({"a.gpkg", {line({}, 0, "A"), line({}, 3, "A")}, {}}, "two rows have the name 'A'");
  expect_refused({"a.gpkg", {line(1, 0), line(2, 0.1)}, {}}, "row 1 and row 2 lie on each other");
  expect_refused({"a.gpkg", {line(1, 0), line(2, 3)}, {post(1, 3, 6)}}, "stands 3.0 m beside row 1");
  expect_refused({"a.gpkg", {line(0, 0)}, {}}, "no number from 1 on");
  expect_refused({"a.gpkg", {}, {}}, "neither lines nor points");
}

}  // namespace
}  // namespace rayfield::density
