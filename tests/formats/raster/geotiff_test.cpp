#include "rayfield/formats/geotiff.h"

#include <cpl_minixml.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "rayfield/core/parallel.h"
#include "tests/formats/gdal_dataset.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using testing::expect_valid_cog;
using testing::kNanFloat;
using testing::message;
using testing::read_file;
using testing::TemporaryFolder;

testing::Dataset open(const std::string& path) { return testing::open_dataset(path, GDAL_OF_RASTER); }

/// Different in every cell, with a hole; not symmetric in any direction.
RasterProduct make_raster(int nx, int ny) {
  RasterProduct raster{"plan_density", "m2/m2", "one-sided leaf area per ground area",
                       Grid2<float>({276196.4736, 6099944.0749}, 0.12, nx, ny)};
  for (int iy = 0; iy < ny; ++iy) {
    for (int ix = 0; ix < nx; ++ix) {
      const bool hole = ix > nx / 3 && ix < nx / 2 && iy > ny / 4 && iy < ny / 2;
      raster.grid.at(ix, iy) = hole ? kNanFloat : static_cast<float>(ix) * 0.001F + static_cast<float>(iy) * 1.7F;
    }
  }
  return raster;
}

bool same(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Values of a band, southern row first, as in Grid2.
std::vector<float> read_northwards(GDALRasterBand& band) {
  const int nx = band.GetXSize(), ny = band.GetYSize();
  std::vector<float> north_up(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny)), values;
  EXPECT_EQ(band.RasterIO(GF_Read, 0, 0, nx, ny, north_up.data(), nx, ny, GDT_Float32, 0, 0, nullptr), CE_None);
  for (int y = ny - 1; y >= 0; --y) {
    values.insert(values.end(), north_up.begin() + static_cast<std::ptrdiff_t>(y) * nx,
                  north_up.begin() + static_cast<std::ptrdiff_t>(y + 1) * nx);
  }
  return values;
}

TEST(GeoTiff, ValuesNanAndGeoreferencingComeBackExactly) {
  const TemporaryFolder folder;
  const RasterProduct raster = make_raster(701, 1033);
  const auto written = write_cog(raster, "EPSG:7854", folder / "a.tif");
  ASSERT_TRUE(written) << message(written);
  const testing::Dataset dataset = open(folder / "a.tif");
  ASSERT_NE(dataset, nullptr);
  ASSERT_EQ(dataset->GetRasterXSize(), 701);
  ASSERT_EQ(dataset->GetRasterYSize(), 1033);
  double transform[6];
  ASSERT_EQ(dataset->GetGeoTransform(transform), CE_None);
  EXPECT_EQ(transform[0], 276196.4736);
  EXPECT_EQ(transform[1], 0.12);
  EXPECT_EQ(transform[2], 0);
  EXPECT_EQ(transform[3], 6099944.0749 + 1033 * 0.12);
  EXPECT_EQ(transform[4], 0);
  EXPECT_EQ(transform[5], -0.12);
  EXPECT_STREQ(dataset->GetSpatialRef()->GetAuthorityCode(nullptr), "7854");
  const std::vector<float> values = read_northwards(*dataset->GetRasterBand(1));
  std::size_t different = 0;
  for (std::size_t i = 0; i < values.size(); ++i) different += same(values[i], raster.grid.values[i]) ? 0 : 1;
  EXPECT_EQ(different, 0U);
}

TEST(GeoTiff, BandCarriesNodataUnitDescriptionAndUserText) {
  const TemporaryFolder folder;
  RasterProduct raster = make_raster(20, 10);
  raster.description = "Grüner \"Veltliner\" <b> & 'more' 葡萄";
  GeoTiffOptions options;
  options.metadata = {{"scan_date", "2019-02-11"}, {"block", "a <&> \"b\""}};
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "a.tif", options));
  const testing::Dataset dataset = open(folder / "a.tif");
  ASSERT_EQ(dataset->GetRasterCount(), 1);
  GDALRasterBand* band = dataset->GetRasterBand(1);
  EXPECT_EQ(band->GetRasterDataType(), GDT_Float32);
  int has_nodata = 0;
  EXPECT_TRUE(std::isnan(band->GetNoDataValue(&has_nodata)));
  EXPECT_NE(has_nodata, 0);
  EXPECT_STREQ(band->GetUnitType(), "m2/m2");
  EXPECT_EQ(std::string(band->GetDescription()), raster.description);
  EXPECT_STREQ(dataset->GetMetadataItem("AREA_OR_POINT"), "Area");
  EXPECT_STREQ(dataset->GetMetadataItem("scan_date"), "2019-02-11");
  EXPECT_STREQ(dataset->GetMetadataItem("block"), "a <&> \"b\"");
  EXPECT_EQ(dataset->GetMetadataItem("TIFFTAG_DATETIME"), nullptr);
}

TEST(GeoTiff, StatisticsStandInsideTheFileAndAreThoseOfTheValidCells) {
  const TemporaryFolder folder;
  // 1 … n over a high base: mean (n+1)/2, population variance (n²−1)/12; a quarter of the cells is NaN.
  const int n = 300;
  RasterProduct raster{"ground", "m", "ground", Grid2<float>({0, 0}, 1, 40, 10, kNanFloat)};
  for (int i = 0; i < n; ++i) raster.grid.values[static_cast<std::size_t>(i)] = static_cast<float>(100000 + i + 1);
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "g.tif"));
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"g.qml", "g.tif"}));
  const testing::Dataset dataset = open(folder / "g.tif");
  GDALRasterBand* band = dataset->GetRasterBand(1);
  const auto item = [band](const char* key) {
    const char* text = band->GetMetadataItem(key);
    return text == nullptr ? testing::kNan : std::atof(text);
  };
  EXPECT_EQ(item("STATISTICS_MINIMUM"), 100001);
  EXPECT_EQ(item("STATISTICS_MAXIMUM"), 100300);
  EXPECT_NEAR(item("STATISTICS_MEAN"), 100150.5, 1e-9);
  EXPECT_NEAR(item("STATISTICS_STDDEV"), std::sqrt((300.0 * 300.0 - 1) / 12), 1e-9);
  EXPECT_NEAR(item("STATISTICS_VALID_PERCENT"), 75, 1e-9);
  EXPECT_FALSE(std::filesystem::exists(folder / "g.tif.aux.xml"));
}

TEST(GeoTiff, AStaleSidecarOfAnOlderFileIsRemoved) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.tif.aux.xml") << "<PAMDataset/>";
  ASSERT_TRUE(write_cog(make_raster(20, 10), "EPSG:7854", folder / "a.tif"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.tif.aux.xml"));
}

TEST(GeoTiff, OverviewsAreMeansOfTheCellsThatHaveValues) {
  const TemporaryFolder folder;
  const int nx = 1024, ny = 2048;
  RasterProduct raster{"plan_density", "m2/m2", "", Grid2<float>({276000, 6099000}, 0.12, nx, ny)};
  std::mt19937 random(7);
  // Multiples of 1/64 below 8: sums of four are exact in float, so the mean must be exact.
  for (float& value : raster.grid.values) value = static_cast<float>(random() % 512) / 64.0F;
  for (int ix = 0; ix < 6; ++ix) raster.grid.at(ix, 0) = kNanFloat;  // lower cells of three blocks of four
  for (int ix = 2; ix < 6; ++ix) raster.grid.at(ix, 1) = kNanFloat;  // two of these wholly
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "a.tif"));
  const testing::Dataset dataset = open(folder / "a.tif");
  GDALRasterBand* band = dataset->GetRasterBand(1);
  ASSERT_GE(band->GetOverviewCount(), 2);
  ASSERT_EQ(band->GetOverview(0)->GetXSize(), nx / 2);
  const std::vector<float> coarse = read_northwards(*band->GetOverview(0));
  double fine_sum = 0, coarse_sum = 0;
  for (int oy = 0; oy < ny / 2; ++oy) {
    for (int ox = 0; ox < nx / 2; ++ox) {
      float sum = 0;
      int count = 0;
      for (const int k : {0, 1, 2, 3}) {
        const float cell = raster.grid.at(2 * ox + k % 2, 2 * oy + k / 2);
        if (!std::isnan(cell)) sum += cell, ++count;
      }
      const float expected = count == 0 ? kNanFloat : sum / static_cast<float>(count);
      const float got = coarse[static_cast<std::size_t>(oy) * (nx / 2) + static_cast<std::size_t>(ox)];
      ASSERT_TRUE(same(got, expected)) << ox << "," << oy << ": " << got << " instead of " << expected;
      if (oy > 0) fine_sum += static_cast<double>(sum), coarse_sum += 4.0 * static_cast<double>(got);
    }
  }
  EXPECT_EQ(fine_sum, coarse_sum);
}

TEST(GeoTiff, PassesTheCogValidatorInEverySizeAndOption) {
  const TemporaryFolder folder;
  for (const auto& [nx, ny] : {std::pair(1, 1), {20, 10}, {512, 512}, {513, 1025}, {3000, 40}}) {
    const std::string path = folder / fmt::format("v{}.tif", nx);
    ASSERT_TRUE(write_cog(make_raster(nx, ny), "EPSG:7854", path));
    expect_valid_cog(path);
  }
  GeoTiffOptions options;
  options.compression = GeoTiffOptions::Compression::zstd;
  options.block_size = 256;
  ASSERT_TRUE(write_cog(make_raster(900, 700), "EPSG:7854", folder / "z.tif", options));
  expect_valid_cog(folder / "z.tif");
}

TEST(GeoTiff, ARasterWithoutAnyValueIsValidToo) {
  const TemporaryFolder folder;
  const RasterProduct raster{"plan_density", "m2/m2", "", Grid2<float>({0, 0}, 1, 600, 600, kNanFloat)};
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "n.tif"));
  expect_valid_cog(folder / "n.tif");
  const testing::Dataset dataset = open(folder / "n.tif");
  EXPECT_EQ(dataset->GetRasterBand(1)->GetMetadataItem("STATISTICS_MEAN"), nullptr);
  for (const float value : read_northwards(*dataset->GetRasterBand(1))) ASSERT_TRUE(std::isnan(value));
}

TEST(GeoTiff, EqualInputGivesEqualBytesWhateverTheThreads) {
  const TemporaryFolder folder;
  const RasterProduct raster = make_raster(1500, 1200);
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "reference.tif"));
  const std::string reference = read_file(folder / "reference.tif");
  ASSERT_EQ(::setenv("GDAL_NUM_THREADS", "4", 1), 0);
  const auto written = parallel_for(
      4, 4, [&](std::size_t i, int) { return write_cog(raster, "EPSG:7854", folder / fmt::format("t{}.tif", i)); });
  ::unsetenv("GDAL_NUM_THREADS");
  ASSERT_TRUE(written) << message(written);
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(read_file(folder / fmt::format("t{}.tif", i)) == reference) << "thread " << i;
    EXPECT_EQ(read_file(folder / fmt::format("t{}.qml", i)), read_file(folder / "reference.qml"));
  }
}

TEST(GeoTiff, NanBitPatternsDoNotChangeTheBytes) {
  const TemporaryFolder folder;
  RasterProduct raster = make_raster(64, 64);
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "a.tif"));
  for (float& value : raster.grid.values) {
    if (std::isnan(value)) value = std::copysign(std::nanf("123"), -1.0F);
  }
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "b.tif"));
  EXPECT_TRUE(read_file(folder / "a.tif") == read_file(folder / "b.tif"));
}

TEST(GeoTiff, RowsReadInBandsGiveTheSameFileAndComeOnceFromNorthToSouth) {
  const TemporaryFolder folder;
  const RasterProduct raster = make_raster(700, 600);
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "whole.tif"));
  const RasterLayout layout{raster.name, raster.unit, raster.description, raster.grid.origin, 0.12, 700, 600};
  for (const int rows : {1, 7, 512, 65536}) {
    int next_top = 600;
    const RowReader read = [&](int iy_begin, int count, std::span<float> values) -> Result<void> {
      EXPECT_EQ(iy_begin + count, next_top);
      EXPECT_EQ(values.size(), static_cast<std::size_t>(count) * 700);
      next_top = iy_begin;
      std::copy_n(raster.grid.values.begin() + static_cast<std::ptrdiff_t>(iy_begin) * 700, values.size(),
                  values.begin());
      return {};
    };
    GeoTiffOptions options;
    options.rows_per_band = rows;
    const auto written = write_cog(layout, read, "EPSG:7854", folder / "bands.tif", options);
    ASSERT_TRUE(written) << message(written);
    EXPECT_EQ(next_top, 0);
    EXPECT_TRUE(read_file(folder / "bands.tif") == read_file(folder / "whole.tif")) << rows << " rows at a time";
  }
}

TEST(GeoTiff, AnErrorOfTheRowReaderIsReturnedAndNothingIsLeftBehind) {
  const TemporaryFolder folder;
  const RowReader read = [](int iy_begin, int, std::span<float>) -> Result<void> {
    if (iy_begin > 0) return {};
    return fail(ErrorCode::damaged, "cannot read tile", "tile 3", "bad checksum");
  };
  const auto written = write_cog({"ground", "m", "", {0, 0}, 1, 100, 2000}, read, "EPSG:7854", folder / "a.tif");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::damaged);
  EXPECT_EQ(written.error().where, "tile 3");
  EXPECT_TRUE(folder.names().empty());
}

TEST(GeoTiff, WrongInputIsRefusedWithTheRightCode) {
  const TemporaryFolder folder;
  RasterProduct raster = make_raster(20, 10);
  const auto code = [](const Result<void>& result) { return result ? ErrorCode{} : result.error().code; };
  EXPECT_EQ(code(write_cog(raster, "EPSG:99999", folder / "a.tif")), ErrorCode::usage);
  EXPECT_EQ(code(write_cog(raster, "", folder / "a.tif")), ErrorCode::usage);
  EXPECT_EQ(code(write_cog(raster, "/etc/passwd", folder / "a.tif")), ErrorCode::usage);
  EXPECT_EQ(code(write_cog(raster, "EPSG:7854", folder / "missing/a.tif")), ErrorCode::bad_input);
  EXPECT_EQ(code(write_cog(raster, "EPSG:7854", folder.path())), ErrorCode::usage);
  GeoTiffOptions options;
  options.block_size = 500;
  EXPECT_EQ(code(write_cog(raster, "EPSG:7854", folder / "a.tif", options)), ErrorCode::usage);
  options = {};
  options.scale = ColorScale{1, 1, Ramp::canopy};
  EXPECT_EQ(code(write_cog(raster, "EPSG:7854", folder / "a.tif", options)), ErrorCode::usage);
  options = {};
  options.metadata = {{"a=b", "c"}};
  EXPECT_EQ(code(write_cog(raster, "EPSG:7854", folder / "a.tif", options)), ErrorCode::usage);
  raster.grid.at(3, 4) = std::numeric_limits<float>::infinity();
  EXPECT_EQ(code(write_cog(raster, "EPSG:7854", folder / "a.tif")), ErrorCode::internal);
  raster.grid.nx = 21;
  EXPECT_EQ(code(write_cog(raster, "EPSG:7854", folder / "a.tif")), ErrorCode::internal);
  raster.grid = Grid2<float>({0, 0}, 1, 0, 0);
  EXPECT_EQ(code(write_cog(raster, "EPSG:7854", folder / "a.tif")), ErrorCode::internal);
  EXPECT_TRUE(folder.names().empty());
}

/// minimum and maximum of the colour ramp in a raster style.
std::pair<double, double> style_range(const std::string& path) {
  CPLXMLNode* root = CPLParseXMLFile(path.c_str());
  EXPECT_NE(root, nullptr) << path << " is not well-formed";
  const CPLXMLNode* shader = CPLSearchXMLNode(root, "=colorrampshader");
  const std::pair<double, double> range = {CPLAtof(CPLGetXMLValue(shader, "minimumValue", "nan")),
                                           CPLAtof(CPLGetXMLValue(shader, "maximumValue", "nan"))};
  CPLDestroyXMLNode(root);
  return range;
}

TEST(GeoTiff, TheStyleHasTheProductsFixedScaleWhateverTheData) {
  const TemporaryFolder folder;
  RasterProduct raster = make_raster(20, 10);
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "a.tif"));
  for (float& value : raster.grid.values) value *= 0.1F;
  raster.unit = "<\"m2\"&>";
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "b.tif"));
  EXPECT_EQ(style_range(folder / "a.qml"), std::pair(0.0, 8.0));
  EXPECT_EQ(style_range(folder / "b.qml"), std::pair(0.0, 8.0));
  GeoTiffOptions options;
  options.scale = ColorScale{1, 3, Ramp::height};
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "c.tif", options));
  EXPECT_EQ(style_range(folder / "c.qml"), std::pair(1.0, 3.0));
  options.write_style = false;
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "d.tif", options));
  EXPECT_FALSE(std::filesystem::exists(folder / "d.qml"));
}

TEST(GeoTiff, AStyleAloneIsTheOneThatComesWithTheRaster) {
  const TemporaryFolder folder;
  RasterProduct raster{"plan_density", "m2/m2", "", Grid2<float>({276000, 6099000}, 0.5, 4, 4, 1.0F)};
  GeoTiffOptions options;
  options.scale = ColorScale{0, 15, Ramp::canopy};
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "a.tif", options));
  ASSERT_TRUE(write_raster_style(*options.scale, "m2/m2", folder / "b.qml"));
  EXPECT_EQ(read_file(folder / "b.qml"), read_file(folder / "a.qml"));
  EXPECT_EQ(style_range(folder / "b.qml"), std::pair(0.0, 15.0));
  const auto refused = write_raster_style({1, 1, Ramp::canopy}, "m", folder / "c.qml");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
}

TEST(GeoTiff, ThePlainProfileIsUncompressedAndWithoutOverviews) {
  const TemporaryFolder folder;
  const RasterProduct raster = make_raster(700, 600);
  GeoTiffOptions options;
  options.profile = GeoTiffOptions::Profile::plain;
  ASSERT_TRUE(write_cog(raster, "EPSG:7854", folder / "p.tif", options));
  const testing::Dataset dataset = open(folder / "p.tif");
  EXPECT_EQ(dataset->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE"), nullptr);
  EXPECT_EQ(dataset->GetRasterBand(1)->GetOverviewCount(), 0);
  const std::vector<float> values = read_northwards(*dataset->GetRasterBand(1));
  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_TRUE(same(values[i], raster.grid.values[i]));
}

}  // namespace
}  // namespace rayfield::formats
