#include <gtest/gtest.h>

#include <cstdlib>

#include "formats/chart/chart_axes.h"
#include "rayfield/formats/chart.h"
#include "tests/formats/png_image.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using testing::find;
using testing::Image;
using testing::kNan;
using testing::message;
using testing::read_file;
using testing::read_png;
using testing::TemporaryFolder;

/// The first series falls, the second, in another colour, rises; both as discs.
SeriesChart make_chart() {
  SeriesChart chart{"rays", "error, %", {1, 10, 100}, {}, true, {}};
  const ChartSeries falls{"falls", {{1, 30, 1}, {10, 10, 1}, {100, 0, 1}}, SeriesMark::discs};
  const ChartSeries rises{"rises", {{1, -30, 1}, {10, -10, 1}, {100, kNan, 1}}, SeriesMark::discs};
  chart.panels = {{"left", {falls}}, {"right", {rises}}};
  return chart;
}

TEST(SeriesChart, DrawsEachSeriesInItsColourInItsPanel) {
  const TemporaryFolder folder;
  const auto written = write_series_chart(make_chart(), folder / "c.png", {});
  ASSERT_TRUE(written) << message(written);
  const Image image = read_png(folder / "c.png");
  EXPECT_EQ(image.width, 1600);
  // The key takes a disc of each; the panels hold three and two more.
  const auto falls = find(image, kGainColor, 1), rises = find(image, kLossColor, 1);
  ASSERT_GT(falls.count, 3 * 40);
  ASSERT_GT(rises.count, 2 * 40);
  EXPECT_GT(falls.count, rises.count) << "a value that is no number is left out";
}

TEST(SeriesChart, IsTheSameBytesAgainAndWellFormedAsSvg) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "b.png", "a.svg"}) ASSERT_TRUE(write_series_chart(make_chart(), folder / name, {}));
  EXPECT_EQ(read_file(folder / "a.png"), read_file(folder / "b.png"));
  const std::string command =
      "python3 -c 'import sys, xml.dom.minidom; xml.dom.minidom.parse(sys.argv[1])' '" + (folder / "a.svg") + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(SeriesChart, RefusesWhatCannotBeDrawn) {
  const TemporaryFolder folder;
  const auto refused = [&](SeriesChart chart) {
    const auto written = write_series_chart(chart, folder / "r.png", {});
    return written ? std::string("written") : written.error().why;
  };
  SeriesChart no_panel = make_chart(), one_tick = no_panel, zero = no_panel, labels = no_panel, empty = no_panel;
  no_panel.panels.clear();
  one_tick.x_ticks = {1};
  zero.x_ticks = {0, 1};
  labels.x_labels = {"one"};
  for (ChartPanel& panel : empty.panels) panel.series.front().points = {{1, kNan, 0}};
  EXPECT_EQ(refused(no_panel), "there is no panel to draw");
  EXPECT_EQ(refused(one_tick), "the ticks are not two or more ascending values");
  EXPECT_EQ(refused(zero), "a logarithmic axis has a tick at or below 0");
  EXPECT_EQ(refused(labels), "there are not as many labels as ticks");
  EXPECT_EQ(refused(empty), "there are no values to draw");
}

}  // namespace
}  // namespace rayfield::formats
