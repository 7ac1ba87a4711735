#include "rayfield/formats/chart.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "formats/chart/chart_axes.h"
#include "tests/formats/png_image.h"
#include "tests/formats/season_support.h"

namespace rayfield::formats {
namespace {

using testing::Blob;
using testing::find;
using testing::Image;
using testing::kNan;
using testing::make_block;
using testing::make_comparison;
using testing::make_season;
using testing::message;
using testing::read_file;
using testing::read_png;
using testing::TemporaryFolder;

/// Well-formed XML, as Python's parser judges it.
void expect_xml(const std::string& path) {
  const std::string command =
      "python3 -c 'import sys, xml.dom.minidom; xml.dom.minidom.parse(sys.argv[1])' '" + path + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(ChartAxis, BeginsAtZeroAndEndsAtTheTickAboveTheValues) {
  const ChartAxis positive = value_axis(0.7, 4.3, 7);
  EXPECT_EQ(positive.low, 0);
  EXPECT_EQ(positive.high, 5);
  EXPECT_EQ(positive.ticks.front(), 0);
  EXPECT_EQ(positive.ticks.back(), 5);
  const ChartAxis negative = value_axis(-0.3, 1.2, 7);
  EXPECT_LE(negative.low, -0.3);
  EXPECT_GE(negative.high, 1.2);
  const ChartAxis nothing = value_axis(0, 0, 7);
  EXPECT_LT(nothing.low, nothing.high);
}

TEST(ChartAxis, DaysAreCountedThroughLeapYears) {
  EXPECT_EQ(*day_of("1970-01-01"), 0);
  EXPECT_EQ(*day_of("2000-03-01") - *day_of("2000-02-28"), 2);
  EXPECT_EQ(*day_of("2019-03-01") - *day_of("2019-02-28"), 1);
  EXPECT_EQ(day_of("2019-02-30").error().code, ErrorCode::usage);
}

TEST(ChartAxis, MonthsAreMarkedAtTheirFirstsAndThinnedOutOverYears) {
  const MonthTicks season = month_ticks(*day_of("2018-08-20"), *day_of("2019-02-20"), 8);
  ASSERT_EQ(season.labels.size(), 6U);
  EXPECT_EQ(season.labels.front(), "2018-09");
  EXPECT_EQ(season.labels.back(), "2019-02");
  EXPECT_EQ(season.days.front(), *day_of("2018-09-01"));
  const MonthTicks years = month_ticks(*day_of("2015-02-01"), *day_of("2024-11-01"), 5);
  EXPECT_LE(years.labels.size(), 5U);
  EXPECT_GE(years.labels.size(), 3U);
  EXPECT_EQ(years.labels.front().substr(5), "01");
}

TEST(ScatterChart, ShowsGainsAndLossesInTheirColoursOnTheirSidesOfTheLine) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(2, 2, {"2019-01-11", "2019-02-11"});
  for (std::size_t i = 0; i < 4; ++i) {
    PanelValue &a = block.scans[0].panel_values[i], &b = block.scans[1].panel_values[i];
    a.leaf_area_m2 = 10, b.leaf_area_m2 = i == 0 ? 20 : i == 1 ? 4 : 10;
    for (PanelValue* v : {&a, &b}) v->ci_low_m2 = v->leaf_area_m2 - 0.01, v->ci_high_m2 = v->leaf_area_m2 + 0.01;
  }
  DateComparison c = make_comparison(block);
  const auto written = write_scatter_chart(c, folder / "s.png");
  ASSERT_TRUE(written) << message(written);
  const Image image = read_png(folder / "s.png");
  EXPECT_EQ(image.width, 1600);
  // The chart's left 70 %: the words stand to the right of it.
  const Blob gain = find(image, kGainColor, 0.7), loss = find(image, kLossColor, 0.7);
  ASSERT_GT(gain.count, 30);
  ASSERT_GT(loss.count, 30);
  EXPECT_LT(gain.y, loss.y) << "more leaf area is further up";
  EXPECT_NEAR(gain.x, loss.x, 3) << "equal on the first date";
}

TEST(ScatterChart, IsTheSameInPngAndSvgAndRepeatsByteForByte) {
  const TemporaryFolder folder;
  const DateComparison c = make_comparison(make_block(3, 4, {"2019-01-11", "2019-02-11"}));
  PictureOptions options;
  options.title = "Block <a> & \"b\"";
  options.subtitle = "2019-01-11 → 2019-02-11";
  for (const char* name : {"a.png", "b.png", "a.svg", "b.svg"})
    ASSERT_TRUE(write_scatter_chart(c, folder / name, options));
  EXPECT_TRUE(read_file(folder / "a.png") == read_file(folder / "b.png"));
  EXPECT_TRUE(read_file(folder / "a.svg") == read_file(folder / "b.svg"));
  EXPECT_EQ(read_file(folder / "a.svg").substr(0, 5), "<?xml");
  expect_xml(folder / "a.svg");
}

TEST(ScatterChart, OnePanelAndPanelsBelowZeroAreDrawnAndNoneIsRefused) {
  const TemporaryFolder folder;
  DateComparison c = make_comparison(make_block(1, 1, {"2019-01-11", "2019-02-11"}));
  c.leaf_per_m.slope = c.leaf_per_m.r_squared = c.leaf_per_m.rrmse = kNan;
  EXPECT_TRUE(write_scatter_chart(c, folder / "one.png"));
  c.panels[0].a.leaf_area_m2 = -0.2, c.panels[0].a.ci_low_m2 = 0;
  c.leaf_total.area_a_m2 = -0.2;
  EXPECT_TRUE(write_scatter_chart(c, folder / "negative.png"));
  c.panels[0].verdict = ChangeVerdict::not_seen;
  const auto none = write_scatter_chart(c, folder / "none.png");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::usage);
  EXPECT_EQ(folder.names().size(), 2U);
}

TEST(SeasonChart, DrawsARowAboveAnotherThatHasLessInPngAndSvg) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(3, 2, {"2018-09-28", "2018-11-22", "2019-02-11"});
  const std::vector<SeasonValue> values = make_season(block);
  const std::vector<int> rows = {1, 2, 3};
  for (const char* name : {"a.png", "b.png", "a.svg", "b.svg"}) {
    const auto written = write_season_chart(block, values, rows, folder / name);
    ASSERT_TRUE(written) << message(written);
  }
  EXPECT_TRUE(read_file(folder / "a.png") == read_file(folder / "b.png"));
  EXPECT_TRUE(read_file(folder / "a.svg") == read_file(folder / "b.svg"));
  expect_xml(folder / "a.svg");
  EXPECT_GT(find(read_png(folder / "a.png"), kGainColor).count, 500);
}

TEST(SeasonChart, ManyRowsOneDateAndMissingRowsAreDrawnAndNothingIsRefused) {
  const TemporaryFolder folder;
  const BlockProducts many = make_block(31, 1, {"2018-09-28", "2019-02-11"});
  std::vector<int> rows(31);
  for (int i = 0; i < 31; ++i) rows[static_cast<std::size_t>(i)] = i + 1;
  std::vector<SeasonValue> values = make_season(many);
  for (SeasonValue& v : values)
    if (v.row_number == 7) v.leaf_area_per_m = v.ci_low_per_m = v.ci_high_per_m = kNan;
  ASSERT_TRUE(write_season_chart(many, values, rows, folder / "many.png"));
  EXPECT_GT(read_png(folder / "many.png").height, 2000);

  const BlockProducts once = make_block(1, 1, {"2018-09-28"});
  EXPECT_TRUE(write_season_chart(once, make_season(once), std::vector<int>{1}, folder / "once.png"));
  const auto nothing = write_season_chart(once, {}, std::vector<int>{1}, folder / "nothing.png");
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::formats
