#include "formats/picture/canvas.h"

#include <gtest/gtest.h>

#include "tests/formats/png_image.h"
#include "tests/formats/temporary_file.h"

namespace rayfield::formats {
namespace {

using testing::Blob;
using testing::find;
using testing::Image;
using testing::read_png;
using testing::TemporaryFolder;

TEST(Canvas, DrawsWhereItIsToldAndRefusesImpossibleSizes) {
  const TemporaryFolder folder;
  EXPECT_FALSE(Canvas::create(0, 10));
  EXPECT_FALSE(Canvas::create(10, 1000000));
  auto canvas = Canvas::create(100, 50);
  ASSERT_TRUE(canvas);
  canvas->rectangle({10, 20}, {30, 5}, {255, 0, 0, 255});
  canvas->text({60, 40}, "x", {20, {0, 0, 0, 255}});
  ASSERT_TRUE(canvas->write(folder / "c.png"));
  const Image image = read_png(folder / "c.png");
  ASSERT_EQ(image.width, 100);
  ASSERT_EQ(image.height, 50);
  const Blob red = find(image, {255, 0, 0, 255});
  EXPECT_EQ(red.count, 150);
  EXPECT_EQ(red.low_x, 10);
  EXPECT_EQ(red.low_y, 20);
  int dark = 0;
  for (int y = 25; y < 41; ++y) {
    for (int x = 58; x < 76; ++x) dark += image.at(x, y).g < 100 ? 1 : 0;
  }
  EXPECT_GT(dark, 10) << "no letter was drawn";
}

TEST(Canvas, TheEndingOfAPathSaysTheFormat) {
  EXPECT_EQ(format_of("maps/a.svg"), PictureFormat::svg);
  EXPECT_EQ(format_of("A.SVG"), PictureFormat::svg);
  EXPECT_EQ(format_of("svg.png"), PictureFormat::png);
  EXPECT_EQ(format_of("svg"), PictureFormat::png);
}

TEST(Canvas, AnSvgHoldsShapesAndOutlinesOfLettersAndRepeatsByteForByte) {
  const auto draw = [] {
    auto canvas = Canvas::create(100, 50, {255, 255, 255, 255}, PictureFormat::svg);
    EXPECT_TRUE(canvas);
    canvas->rectangle({10, 20}, {30, 5}, {255, 0, 0, 255});
    canvas->text({60, 40}, "x & y", {20, {0, 0, 0, 255}});
    auto bytes = canvas->bytes();
    EXPECT_TRUE(bytes);
    return *bytes;
  };
  const std::string svg = draw();
  EXPECT_EQ(svg.find("<?xml"), 0U);
  EXPECT_NE(svg.find("width=\"100px\""), std::string::npos) << svg.substr(0, 300);
  EXPECT_NE(svg.find("glyph"), std::string::npos);
  EXPECT_EQ(svg.find("font-family"), std::string::npos) << "no font is needed to show it";
  EXPECT_TRUE(draw() == svg) << "cairo counts surfaces through the life of a process";
}

}  // namespace
}  // namespace rayfield::formats
