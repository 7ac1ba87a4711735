#include "rayfield/formats/picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "formats/picture/color.h"
#include "tests/formats/png_image.h"
#include "tests/formats/products_support.h"
#include "tests/formats/season_support.h"

namespace rayfield::formats {
namespace {

using Eigen::Vector2d;
using testing::Blob;
using testing::find;
using testing::Image;
using testing::kNanFloat;
using testing::make_block;
using testing::message;
using testing::read_file;
using testing::read_png;
using testing::TemporaryFolder;

/// Share of the width from the left, to leave out the legend.
constexpr double kWithoutLegend = 0.8;

/// A scale whose every value differs from the greys around the map; the value between two stops is not on the ramp's
/// ends.
const ColorScale kScale{0, 8, Ramp::canopy};

RasterProduct flat(int nx, int ny, float value) {
  return {"plan_density", "m2/m2", "", Grid2<float>({276100, 6099900}, 0.5, nx, ny, value)};
}

/// The legend's bar shows every colour once; blocks of cells are far larger.
constexpr int kMoreThanTheLegend = 200;

TEST(PlanPicture, ShowsEachValueInItsColourWithNorthUpAndEastRight) {
  const TemporaryFolder folder;
  RasterProduct raster = flat(80, 60, 0);
  const auto patch = [&raster](int x, int y, float value) {
    for (int iy = y; iy < y + 10; ++iy) {
      for (int ix = x; ix < x + 10; ++ix) raster.grid.at(ix, iy) = value;
    }
  };
  patch(5, 45, 2);   // north-west
  patch(65, 45, 4);  // north-east
  patch(5, 5, 6);    // south-west
  const auto written = write_plan_picture(raster, {}, folder / "p.png");
  ASSERT_TRUE(written) << message(written);
  const Image image = read_png(folder / "p.png");
  const Blob nw = find(image, color_at(kScale, 2)), ne = find(image, color_at(kScale, 4)),
             sw = find(image, color_at(kScale, 6));
  ASSERT_GT(nw.count, kMoreThanTheLegend);
  ASSERT_GT(ne.count, kMoreThanTheLegend);
  ASSERT_GT(sw.count, kMoreThanTheLegend);
  EXPECT_LT(nw.x, ne.x);
  EXPECT_LT(nw.y, sw.y);
  EXPECT_NEAR(nw.x, sw.x, 0.05 * image.width);
  EXPECT_GT(find(image, color_at(kScale, 0)).count, 10 * kMoreThanTheLegend);
}

TEST(PlanPicture, CellsThatWereNotScannedAreHatchedGreyNotColoured) {
  const TemporaryFolder folder;
  RasterProduct raster = flat(80, 60, 0);
  for (int iy = 20; iy < 40; ++iy) {
    for (int ix = 20; ix < 60; ++ix) raster.grid.at(ix, iy) = kNanFloat;
  }
  PictureOptions options;
  options.crop_to_data = false;
  options.coordinates = false;
  ASSERT_TRUE(write_plan_picture(raster, {}, folder / "p.png", options));
  const Image image = read_png(folder / "p.png");
  // Zero covers the raster but for the hole; the hole's middle is the middle of that area.
  const Blob zero = find(image, color_at(kScale, 0), kWithoutLegend);
  const int cx = (zero.low_x + zero.high_x) / 2, cy = (zero.low_y + zero.high_y) / 2;
  int lightest = 0, darkest = 255;
  for (int y = cy - 20; y < cy + 20; ++y) {
    for (int x = cx - 20; x < cx + 20; ++x) {
      const Rgba& p = image.at(x, y);
      ASSERT_TRUE(p.r == p.g && p.g == p.b) << "coloured at " << x << "," << y;
      lightest = std::max<int>(lightest, p.r), darkest = std::min<int>(darkest, p.r);
    }
  }
  EXPECT_GT(lightest - darkest, 10) << "no hatching";
}

TEST(PlanPicture, FineCellsAreAveragedByArea) {
  const TemporaryFolder folder;
  // A chessboard of 2 and 6 with many cells a pixel: every pixel must be near 4, and no 2 or 6 remain.
  RasterProduct raster = flat(8000, 6000, 2);
  for (int iy = 0; iy < 6000; ++iy) {
    for (int ix = iy % 2; ix < 8000; ix += 2) raster.grid.at(ix, iy) = 6;
  }
  PictureOptions options;
  options.width_px = 500;
  options.coordinates = false;
  ASSERT_TRUE(write_plan_picture(raster, {}, folder / "p.png", options));
  const Image image = read_png(folder / "p.png");
  const Rgba mean = color_at(kScale, 4), near_low = color_at(kScale, 3.9), near_high = color_at(kScale, 4.1);
  const auto between = [](int value, int a, int b) { return value >= std::min(a, b) && value <= std::max(a, b); };
  int good = 0, bad = 0;
  for (int y = image.height / 3; y < image.height / 2; ++y) {
    for (int x = image.width / 5; x < image.width / 2; ++x) {
      const Rgba& p = image.at(x, y);
      const bool close = between(p.r, near_low.r, near_high.r) || p.r == mean.r;
      const bool same_family = between(p.g, near_low.g, near_high.g) || p.g == mean.g;
      (close && same_family ? good : bad) += 1;
    }
  }
  EXPECT_GT(good, 1000);
  EXPECT_EQ(bad, 0);
}

TEST(PlanPicture, OverlaysLieOnTheCellsTheyBelongTo) {
  const TemporaryFolder folder;
  RasterProduct raster = flat(80, 60, 0);
  for (int iy = 40; iy < 44; ++iy) {
    for (int ix = 60; ix < 64; ++ix) raster.grid.at(ix, iy) = 6;
  }
  const Vector2d middle = raster.grid.origin + 0.5 * Vector2d(62, 42);
  ASSERT_TRUE(write_plan_picture(raster, {}, folder / "without.png"));
  const Blob cells = find(read_png(folder / "without.png"), color_at(kScale, 6), kWithoutLegend);
  PlanOverlay overlay;
  overlay.markers.push_back({middle, {255, 0, 255, 255}, 4});
  ASSERT_TRUE(write_plan_picture(raster, overlay, folder / "with.png"));
  const Blob marker = find(read_png(folder / "with.png"), {255, 0, 255, 255});
  ASSERT_GT(marker.count, 20);
  ASSERT_GT(cells.count, kMoreThanTheLegend);
  EXPECT_NEAR(marker.x, (cells.low_x + cells.high_x + 1) / 2.0, 1.0);
  EXPECT_NEAR(marker.y, (cells.low_y + cells.high_y + 1) / 2.0, 1.0);
}

TEST(PlanPicture, HasTheWidthAskedForStaysUnderTheHeightAndRepeatsByteForByte) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(4, 6, {"2019-02-11"});
  RasterProduct raster = flat(40, 200, 3);
  raster.grid.origin = block.rows[0].centreline[0] - Vector2d(3, 3);
  PictureOptions options;
  options.title = "Block <a> & \"b\" Grüner \xff 葡萄";
  options.subtitle = "2019-02-11";
  for (const auto& [width, height] : {std::pair(1600, 1800), {800, 600}, {3200, 2000}}) {
    options.width_px = width;
    options.max_height_px = height;
    ASSERT_TRUE(write_plan_picture(raster, block_overlay(block), folder / "a.png", options));
    ASSERT_TRUE(write_plan_picture(raster, block_overlay(block), folder / "b.png", options));
    EXPECT_TRUE(read_file(folder / "a.png") == read_file(folder / "b.png"));
    const Image image = read_png(folder / "a.png");
    EXPECT_GT(image.width, width / 2);
    EXPECT_LE(image.width, width);
    EXPECT_LE(image.height, height + 2);
  }
}

TEST(PlanPicture, ARasterWithoutValuesStillGivesAMap) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_plan_picture(flat(10, 10, kNanFloat), {}, folder / "p.png"));
  EXPECT_GT(read_png(folder / "p.png").width, 400);
}

TEST(PlanPicture, ATrajectoryCanBeDrawnWithoutARaster) {
  const TemporaryFolder folder;
  PlanOverlay plan;
  plan.lines.push_back({{{276100, 6099900}, {276150, 6099900}}, {{0, 0, 255, 255}, 6, 0}, false});
  ASSERT_TRUE(write_plan_picture(plan, folder / "t.png"));
  const Blob line = find(read_png(folder / "t.png"), {0, 0, 255, 255});
  EXPECT_GT(line.high_x - line.low_x, 100 * (line.high_y - line.low_y) / 4);
  EXPECT_GT(line.count, 1000);
}

TEST(PlanPicture, WrongInputIsRefused) {
  const TemporaryFolder folder;
  const auto code = [](const Result<void>& result) { return result ? ErrorCode{} : result.error().code; };
  EXPECT_EQ(code(write_plan_picture(PlanOverlay{}, folder / "p.png")), ErrorCode::usage);
  PlanOverlay broken;
  broken.markers.push_back({Vector2d(testing::kNan, 0), {}, 3});
  EXPECT_EQ(code(write_plan_picture(broken, folder / "p.png")), ErrorCode::usage);
  PictureOptions options;
  options.width_px = 10;
  EXPECT_EQ(code(write_plan_picture(flat(10, 10, 1), {}, folder / "p.png", options)), ErrorCode::usage);
  RasterProduct inconsistent = flat(10, 10, 1);
  inconsistent.grid.nx = 11;
  EXPECT_EQ(code(write_plan_picture(inconsistent, {}, folder / "p.png")), ErrorCode::internal);
  EXPECT_EQ(code(write_section_picture(std::span<const LabelledSection>{}, folder / "p.png")), ErrorCode::usage);
  const LabelledSection missing;
  EXPECT_EQ(code(write_section_picture(std::span(&missing, 1), folder / "p.png")), ErrorCode::internal);
  EXPECT_TRUE(folder.names().empty());
}

SectionProduct end_on(float value, double left_m) {
  return {"end_on_row_1", "m2/m3", 1, Grid2<float>({left_m, 0.3}, 0.1, 12, 18, value)};
}

TEST(EndOnPicture, FillsTheSheetWithAnyNumberOfRows) {
  const TemporaryFolder folder;
  for (const std::size_t count : {1U, 2U, 3U, 5U, 9U, 24U, 60U}) {
    const std::vector<SectionProduct> sections(count, end_on(3, -0.6));
    std::vector<LabelledSection> rows;
    for (const SectionProduct& s : sections) rows.push_back({&s, "row 1", {}});
    const auto written = write_end_on_picture(rows, folder / "e.png");
    ASSERT_TRUE(written) << message(written);
    const Image image = read_png(folder / "e.png");
    EXPECT_LE(image.width, 1600);
    EXPECT_LE(image.height, 1510);
    const Blob blob = find(image, color_at({0, 6, Ramp::canopy}, 3));
    // 1.2 m × 1.8 m of each 1.2 m × 2.1 m drawing have values.
    EXPECT_GT(blob.count, 0.28 * image.width * image.height) << count << " rows";
  }
}

TEST(EndOnPicture, AllRowsAreInOneWindowSoThatTheSameHeightIsAtTheSameHeight) {
  const TemporaryFolder folder;
  SectionProduct low = end_on(0, -0.6), high = end_on(0, -0.4);
  low.grid.at(6, 2) = 3, high.grid.at(4, 2) = 4.5;  // both 0.0 … 0.1 m across and 0.5 … 0.6 m high
  const std::vector<LabelledSection> rows = {{&low, "row 1", {}}, {&high, "row 2", {}}};
  ASSERT_TRUE(write_end_on_picture(rows, folder / "e.png"));
  Image image = read_png(folder / "e.png");
  std::fill_n(image.pixels.begin(), 112 * image.width, Rgba{});  // the colour bar shows the same colours
  const Blob first = find(image, color_at({0, 6, Ramp::canopy}, 3)),
             second = find(image, color_at({0, 6, Ramp::canopy}, 4.5));
  ASSERT_GT(first.count, 200);
  ASSERT_GT(second.count, 200);
  EXPECT_NEAR(first.low_y, second.low_y, 1);
  EXPECT_NEAR(first.high_y, second.high_y, 1);
  EXPECT_LT(first.high_x, second.low_x);
}

TEST(Pictures, AreSvgWhereThePathSaysSo) {
  const TemporaryFolder folder;
  const SectionProduct side{"side_view_row_3", "m2/m2", 3, Grid2<float>({0, 0}, 0.1, 200, 25, 0)},
      end = end_on(2, -0.6);
  const LabelledSection row{&end, "row 1", {}};
  ASSERT_TRUE(write_section_picture(side, folder / "side.svg"));
  ASSERT_TRUE(write_end_on_picture(std::span(&row, 1), folder / "end.svg"));
  ASSERT_TRUE(write_plan_picture(flat(40, 40, 3), {}, folder / "plan.svg"));
  for (const char* name : {"side.svg", "end.svg", "plan.svg"}) {
    const std::string svg = read_file(folder / name);
    EXPECT_EQ(svg.substr(0, 5), "<?xml") << name;
    EXPECT_NE(svg.find("data:image/png;base64,"), std::string::npos) << name;
    EXPECT_NE(svg.find("</svg>"), std::string::npos) << name;
  }
}

TEST(BlockOverlay, NumbersEveryPanelBesideItsRow) {
  const BlockProducts block = make_block(2, 4, {"2019-02-11"});
  const PlanOverlay overlay = block_overlay(block);
  ASSERT_EQ(overlay.numbers.size(), block.panels.size());
  for (std::size_t i = 0; i < block.panels.size(); ++i) {
    EXPECT_EQ(overlay.numbers[i].number, block.panels[i].panel_number);
    EXPECT_NEAR(overlay.numbers[i].aside.norm(), 1, 1e-12);
    double nearest = 1e9;
    for (const Vector2d& p : block.panels[i].outline)
      nearest = std::min(nearest, (p - overlay.numbers[i].position).norm());
    EXPECT_LT(nearest, block.panels[i].length_m);
  }
}

TEST(ZoneOverlay, ShadesWhatIsInsideAZoneAndLeavesItsHolesFree) {
  const TemporaryFolder folder;
  const auto square = [](double x, double y, double side) {
    return std::vector<Vector2d>{{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}, {x, y}};
  };
  ManagementZone zone;
  zone.zone = 1, zone.mean = 2.5;
  zone.parts = {{square(276105, 6099905, 20), {square(276110, 6099910, 10)}}};
  const BlockProducts block = make_block(1, 1, {"2019-02-11"});
  PlanOverlay overlay = zone_overlay(block, std::span(&zone, 1), "m2/m");
  ASSERT_EQ(overlay.areas.size(), 1U);
  ASSERT_EQ(overlay.keys.size(), 1U);
  EXPECT_EQ(overlay.keys[0].text, "zone 1: 2.5 m²/m");
  overlay.labels.clear(), overlay.keys.clear();
  overlay.areas[0].fill = {255, 0, 255, 255}, overlay.areas[0].outline.color = {255, 0, 255, 255};
  ASSERT_TRUE(write_plan_picture(flat(60, 60, 0), overlay, folder / "z.png"));
  const Blob shade = find(read_png(folder / "z.png"), {255, 0, 255, 255});
  const double side = shade.high_x - shade.low_x + 1;
  EXPECT_NEAR(static_cast<double>(shade.count), 0.75 * side * side, 0.03 * side * side);
}

TEST(PlanPicture, OfAChangeOutlinesPanelsThatGainedOrLostBoldly) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 4, {"2018-11-22", "2019-02-11"});
  RasterProduct raster = flat(40, 80, 1);
  raster.name = "plan_density_change";
  raster.grid.origin = block.rows[0].centreline[0] - Vector2d(3, 3);
  const PlanOverlay overlay = change_overlay(block, testing::make_comparison(block));
  ASSERT_EQ(overlay.keys.size(), 4U) << "gained, lost, within errors, not seen";
  EXPECT_EQ(overlay.keys.front().text, "panel gained");
  const auto written = write_plan_picture(raster, overlay, folder / "c.png");
  ASSERT_TRUE(written) << message(written);
  EXPECT_GT(find(read_png(folder / "c.png"), color_at({-4, 4, Ramp::change}, 1)).count, 1000);
}

}  // namespace
}  // namespace rayfield::formats
