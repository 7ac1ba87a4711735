#include "rayfield/formats/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "formats/report/report_scales.h"
#include "formats/report/report_words.h"
#include "tests/formats/report/report_support.h"
#include "tests/formats/temporary_file.h"

namespace rayfield::formats {
namespace {

using ::testing::HasSubstr;
using testing::kNan;
using testing::kNanFloat;
using testing::make_report;
using ::testing::Not;

std::string html_of(const BlockReport& report) {
  const auto html = report_html(report);
  EXPECT_TRUE(html) << html.error().line();
  return html.value_or("");
}

nlohmann::json data_of(const std::string& html) {
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const std::size_t begin = html.find(open) + open.size();
  return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

TEST(Report, SaysFirstWhatAGrowerAsks) {
  const std::string html = html_of(make_report());
  const std::size_t glance = html.find("At a glance"), look = html.find("What to look at in the field");
  EXPECT_LT(glance, look);
  EXPECT_LT(look, html.find("Where this comes from"));
  EXPECT_THAT(html, HasSubstr("Leaf area on 11 Feb 2019"));
  EXPECT_THAT(html, HasSubstr("Row 1, panel 1"));
  EXPECT_THAT(html, HasSubstr("2.0 to 3.5 m")) << "the longest gap";
  EXPECT_THAT(html, HasSubstr("Clear loss since 22 Nov 2018"));
}

TEST(Report, NamesInputsAlignmentBeamAndWarnings) {
  const std::string html = html_of(make_report());
  for (const char* text : {"drive.bag", "1 234 567 bytes", "abc123", "aligned: moved +1.00 m east",
                           "13.6 mm + 11.9 mrad", "3 rays left out", "EPSG:7854", "rayfield 9.9"})
    EXPECT_THAT(html, HasSubstr(text));
}

TEST(Report, NamesStayTextWhereverTheyStand) {
  const std::string evil = "</script><img src=x onerror=alert(1)>\"'&{{data}}";
  BlockReport report = make_report();
  report.block.block = report.block.farm = report.block.variety = report.block.crs = evil;
  report.block.rows[0].row_name = report.block.scans[0].scan.name = report.block.scans[1].scan.name = evil;
  report.comparisons[0].a.name = report.software = evil;
  report.scans[0].warnings = {evil};
  report.scans[0].inputs = {{evil, 1, evil}};
  report.scans[0].alignment = report.scans[0].beam = evil;
  report.block.scans[0].scan.leaf_note = evil;
  const std::string html = html_of(report);
  EXPECT_THAT(html, Not(HasSubstr("<img")));
  EXPECT_THAT(html, Not(HasSubstr("onerror=alert(1)>\""))) << "nowhere unescaped";
  std::size_t scripts = 0;
  for (std::size_t at = html.find("<script"); at != std::string::npos; at = html.find("<script", at + 1)) ++scripts;
  EXPECT_EQ(scripts, 2U) << "the data and the page's own";
  EXPECT_EQ(data_of(html)["rows"][0]["name"], evil) << "the page gets the name as it is";
}

TEST(Report, BytesThatAreNoTextDoNotBreakIt) {
  BlockReport report = make_report();
  report.block.block = "\xff\xfe";
  report.block.rows[0].row_name = "\xc3";
  EXPECT_THAT(html_of(report), HasSubstr("Block \xEF\xBF\xBD\xEF\xBF\xBD"));
}

TEST(Report, WhatWasNotObservedIsNullAndNeverZero) {
  BlockReport report = make_report();
  PanelValue& value = report.block.scans[1].panel_values[2];
  value.leaf_area_m2 = value.leaf_area_per_m = value.ci_low_m2 = value.ci_high_m2 = kNan;
  report.scans[1].classes[2] = -1;
  const std::string html = html_of(report);
  const auto data = data_of(html);
  EXPECT_TRUE(data["scans"][1]["values"]["leaf"][2].is_null());
  EXPECT_FALSE(data["scans"][0]["values"]["leaf"][2].is_null());
  EXPECT_EQ(data["scans"][1]["classes"].get<std::string>()[2], '-');
  EXPECT_THAT(html, HasSubstr("1 of 6 panels were not observed"));
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(Report, ValuesAndVerdictsAreThoseOfTheStore) {
  const BlockReport report = make_report();
  const auto data = data_of(html_of(report));
  const PanelValue& value = report.block.scans[1].panel_values[4];
  EXPECT_NEAR(data["scans"][1]["values"]["leaf"][4], value.leaf_area_m2, 0.005);
  EXPECT_NEAR(data["scans"][1]["values"]["low"][4], value.ci_low_m2, 0.005);
  EXPECT_NEAR(data["scans"][1]["values"]["high"][4], value.ci_high_m2, 0.005);
  // make_comparison(): gain, loss, none, not seen in turn, all with 1.96 · 0.25 m² of half interval.
  EXPECT_EQ(data["pairs"][0]["verdicts"], "gln-gl");
  EXPECT_NEAR(data["pairs"][0]["half"][0], 0.49, 0.005);
  EXPECT_TRUE(data["pairs"][0]["half"][3].is_null());
  EXPECT_EQ(data["panels"][4][0], 1) << "the second row";
  EXPECT_EQ(data["panels"][4][1], 2) << "its second panel";
}

TEST(Report, WhatCanopiesAreLikeIsThatOfTheStoreAndNullWhereItIsNotDefined) {
  BlockReport report = make_report();
  report.block.scans[1].scan.fruit_zone_low_m = 0.7, report.block.scans[1].scan.fruit_zone_high_m = 1.1;
  PanelValue& value = report.block.scans[1].panel_values[4];
  value.canopy_width_m = 0.63;
  value.descriptors = {.porosity = 0.27, .leaf_layer_number = 1.44, .fruit_zone_area_per_m = 0.58};
  const auto data = data_of(html_of(report));
  const auto& values = data["scans"][1]["values"];
  EXPECT_EQ(values["width"][4], 0.63);
  EXPECT_EQ(values["porosity"][4], 0.27);
  EXPECT_EQ(values["layers"][4], 1.4);
  EXPECT_EQ(values["fruit"][4], 0.58);
  EXPECT_TRUE(values["exposed"][4].is_null());
  EXPECT_EQ(data["scans"][1]["fruit_zone"].dump(), "[0.7,1.1]");
}

TEST(Report, EqualReportsAreEqualBytes) { EXPECT_EQ(html_of(make_report()), html_of(make_report())); }

TEST(Report, OneDateAloneAndBareVinesMakeOneToo) {
  BlockReport report = make_report();
  report.block.scans.pop_back(), report.scans.pop_back(), report.comparisons.clear(), report.weak.clear();
  report.focus = 0, report.scans[0].dormant = true;
  const std::string html = html_of(report);
  EXPECT_THAT(html, HasSubstr("There is no earlier date to compare with."));
  EXPECT_THAT(html, HasSubstr("nothing can be said of weak places yet"));
}

TEST(Report, PartsThatDoNotBelongTogetherAreRefused) {
  BlockReport report = make_report();
  report.scans.pop_back();
  EXPECT_EQ(report_html(report).error().code, ErrorCode::usage);
  report = make_report();
  report.scans[0].classes.pop_back();
  EXPECT_EQ(report_html(report).error().code, ErrorCode::usage);
  EXPECT_EQ(report_html({}).error().code, ErrorCode::usage);
}

TEST(Report, IsKnownByItsBeginning) {
  const testing::TemporaryFile file(html_of(make_report()), ".html");
  EXPECT_TRUE(is_report(file.path()).value());
  file.write("<!doctype html>\n<html>");
  EXPECT_FALSE(is_report(file.path()).value());
  file.write("");
  EXPECT_FALSE(is_report(file.path()).value());
}

TEST(Coarser, TakesTheMeanOfWhatHasAValue) {
  Grid2<float> grid({10, 20}, 0.5, 3, 2);
  grid.values = {1, 3, 5, kNanFloat, kNanFloat, kNanFloat};
  const Grid2<float> half = coarser(grid, 2);
  EXPECT_EQ(half.nx, 2);
  EXPECT_EQ(half.ny, 1);
  EXPECT_DOUBLE_EQ(half.cell_m, 1);
  EXPECT_EQ(half.origin, grid.origin);
  EXPECT_FLOAT_EQ(half.at(0, 0), 2);
  EXPECT_FLOAT_EQ(half.at(1, 0), 5);
  EXPECT_TRUE(std::isnan(coarser(Grid2<float>({0, 0}, 1, 2, 2, kNanFloat), 2).at(0, 0)));
}

TEST(MapFactor, IsTheSmallestThatKeepsWithinTheBound) {
  const Grid2<float> map({0, 0}, 0.1, 100, 60);
  EXPECT_EQ(report_map_factor(map, 2, {.max_map_cells = 12'000}), 1);
  EXPECT_EQ(report_map_factor(map, 2, {.max_map_cells = 11'999}), 2);
  EXPECT_EQ(report_map_factor(map, 2, {.max_map_cells = 2'999}), 3) << "50 × 30 × 2 are 3000, 34 × 20 × 2 are 1360";
}

TEST(ScaleEnd, IsARoundNumberThatHardlyAnythingExceeds) {
  std::vector<float> values(99, 2.4F);
  values.push_back(50);
  EXPECT_DOUBLE_EQ(scale_end(values), 3);
  EXPECT_DOUBLE_EQ(scale_end({0.07F, -3, kNanFloat, 0}), 0.08);
  EXPECT_DOUBLE_EQ(scale_end({4}), 4);
  EXPECT_DOUBLE_EQ(scale_end({}), 1);
}

TEST(Words, DatesAndNumbersReadAsPeopleWriteThem) {
  EXPECT_EQ(date_text("2019-02-11"), "11 Feb 2019");
  EXPECT_EQ(date_text("2019-12-01"), "1 Dec 2019");
  EXPECT_EQ(date_text("soon"), "soon");
  EXPECT_EQ(number(-1.25, 1), "−1.2");
  EXPECT_EQ(number(-0.01, 1), "0.0");
  EXPECT_EQ(number(kNan, 1), "not observed");
  EXPECT_EQ(signed_number(3.14, 1), "+3.1");
  EXPECT_EQ(signed_number(0.01, 1), "0.0");
  EXPECT_EQ(signed_number(-3.14, 1), "−3.1");
}

}  // namespace
}  // namespace rayfield::formats
