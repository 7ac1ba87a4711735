#include "formats/picture/section_drawing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "formats/picture/color.h"
#include "rayfield/formats/picture.h"
#include "tests/formats/png_image.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using testing::Blob;
using testing::find;
using testing::Image;
using testing::message;
using testing::read_png;
using testing::TemporaryFolder;

SectionProduct section(int nx, int ny) { return {"side_view_row_3", "m2/m2", 3, Grid2<float>({0, 0}, 0.1, nx, ny, 0)}; }

/// A 1 m × 1 m square of one value with its lower left corner at (x, y), in cells of 0.1 m.
void add_square(SectionProduct& product, int x, int y, float value) {
  for (int iy = y; iy < y + 10; ++iy) {
    for (int ix = x; ix < x + 10; ++ix) product.grid.at(ix, iy) = value;
  }
}

TEST(SectionPicture, KeepsProportionsWithTheGroundBelow) {
  const TemporaryFolder folder;
  SectionProduct side = section(200, 25);
  add_square(side, 50, 2, 3);      // low
  add_square(side, 150, 13, 4.5);  // high, further along
  const auto written = write_section_picture(side, folder / "s.png");
  ASSERT_TRUE(written) << message(written);
  const Image image = read_png(folder / "s.png");
  EXPECT_EQ(image.width, 1600);
  const ColorScale section_scale{0, 6, Ramp::canopy};
  const Blob low = find(image, color_at(section_scale, 3)), high = find(image, color_at(section_scale, 4.5));
  ASSERT_GT(low.count, 1000);
  ASSERT_GT(high.count, 1000);
  const auto fill_box = [](const Blob& blob) { return std::sqrt(static_cast<double>(blob.count)); };
  // The bar shows the same colours, so boxes are measured from counts: squares of equal size, 10 m apart, 1.1 m up.
  const double metre_px = fill_box(low);
  EXPECT_NEAR(fill_box(high), metre_px, 0.1 * metre_px);
  EXPECT_GT(high.x, low.x);
  EXPECT_LT(high.y, low.y);
  EXPECT_NEAR((high.x - low.x) / (low.y - high.y), 10 / 1.1, 1.5);
}

TEST(SectionPicture, LongRowsAreContinuedOnFurtherLinesWithoutLosingAnything) {
  const TemporaryFolder folder;
  SectionProduct longer = section(1200, 25), shorter = section(300, 25);
  for (SectionProduct* product : {&longer, &shorter}) {
    for (float& value : product->grid.values) value = 3;
  }
  ASSERT_TRUE(write_section_picture(longer, folder / "long.png"));
  ASSERT_TRUE(write_section_picture(shorter, folder / "short.png"));
  const Image long_image = read_png(folder / "long.png"), short_image = read_png(folder / "short.png");
  const Rgba color = color_at({0, 6, Ramp::canopy}, 3);
  EXPECT_GT(long_image.height, 2 * short_image.height);
  // 120 m and 30 m at nearly the same scale: four times the area, less outlines and axes.
  const double ratio = static_cast<double>(find(long_image, color).count) / find(short_image, color).count;
  EXPECT_NEAR(ratio, 4.0, 0.4);
}

TEST(SectionPicture, ManySectionsStayUnderTheGreatestHeight) {
  const TemporaryFolder folder;
  std::vector<SectionProduct> sections(12, section(500, 25));
  std::vector<LabelledSection> labelled;
  for (const SectionProduct& s : sections) labelled.push_back({&s, "row <&> ü", {0, 6.5, 13}});
  PictureOptions options;
  options.max_height_px = 1500;
  ASSERT_TRUE(write_section_picture(labelled, folder / "s.png", options));
  EXPECT_LE(read_png(folder / "s.png").height, 1500);
}

TEST(RowStackPicture, OnePlaceOfTheRowIsAtOnePlaceOfThePictureOnAllDates) {
  const TemporaryFolder folder;
  // The same square of canopy at 8 … 9 m, in grids that begin elsewhere and have other cells.
  SectionProduct early{"side_view_row_3", "m2/m2", 3, Grid2<float>({0, 0}, 0.1, 200, 25, 0)};
  SectionProduct late{"side_view_row_3", "m2/m2", 3, Grid2<float>({-1, 0}, 0.05, 440, 50, 0)};
  add_square(early, 80, 5, 3);
  for (int iy = 10; iy < 30; ++iy)
    for (int ix = 180; ix < 200; ++ix) late.grid.at(ix, iy) = 4.5;
  const std::vector<LabelledSection> dates = {{&early, "2018-11-22", {8}}, {&late, "2019-02-11", {8}}};
  const auto written = write_row_stack_picture(dates, folder / "s.png");
  ASSERT_TRUE(written) << message(written);
  const Image image = read_png(folder / "s.png");
  const ColorScale section_scale{0, 6, Ramp::canopy};
  const Rgba first = color_at(section_scale, 3), second = color_at(section_scale, 4.5);
  const auto below_legend = [&](const Rgba& color) {
    Image part = image;
    std::fill_n(part.pixels.begin(), 120 * image.width, Rgba{});  // the colour bar shows the same colours
    return find(part, color);
  };
  const Blob above = below_legend(first), below = below_legend(second);
  ASSERT_GT(above.count, 1000);
  ASSERT_GT(below.count, 1000);
  EXPECT_NEAR(above.low_x, below.low_x, 2);
  EXPECT_NEAR(above.high_x, below.high_x, 2);
  EXPECT_LT(above.high_y, below.low_y) << "the earlier date is above";
}

TEST(RowStackPicture, OfALongRowTheSameStretchOfAllDatesStandsTogether) {
  const TemporaryFolder folder;
  std::vector<SectionProduct> sections(3, section(1000, 25));
  for (std::size_t d = 0; d < 3; ++d) add_square(sections[d], 50, 5, 3.0F + static_cast<float>(d) / 2);
  std::vector<LabelledSection> dates;
  for (const SectionProduct& s : sections) dates.push_back({&s, "date", {}});
  PictureOptions options;
  options.max_height_px = 20000;
  ASSERT_TRUE(write_row_stack_picture(dates, folder / "s.png", options));
  const Image image = read_png(folder / "s.png");
  int last = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    Image part = image;
    std::fill_n(part.pixels.begin(), 120 * image.width, Rgba{});
    const Blob blob = find(part, color_at({0, 6, Ramp::canopy}, 3 + 0.5 * static_cast<double>(d)));
    ASSERT_GT(blob.count, 300);
    EXPECT_GT(blob.y, last) << "dates in their order";
    last = static_cast<int>(blob.y);
  }
  EXPECT_LT(last, image.height / 2) << "the first stretch of all dates comes before the second of any";
}

}  // namespace
}  // namespace rayfield::formats
