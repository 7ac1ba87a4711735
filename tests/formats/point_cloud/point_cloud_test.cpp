#include "rayfield/formats/point_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "formats/picture/color.h"
#include "tests/formats/temporary_file.h"

namespace rayfield::formats {
namespace {

using ::testing::HasSubstr;
using testing::read_file;
using testing::TemporaryFolder;

const ColorScale kScale{0, 15, Ramp::canopy};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

PointCloudOptions options() { return {"EPSG:7854", "2019-02-11", "rayfield test", kScale, {276500, 6099800, 0}}; }

DensityPoints three_points() {
  DensityPoints p;
  p.position = {{276543.1234, 6099876.5432, 82.5}, {276501.0, 6099900.25, 80.0001}, {276499.9999, 6099799.5, 84.75}};
  p.time_s = {1549843200.25, 1549843201.5, 1549843202.75};
  p.intensity = {80, 0, 60000};
  p.density = {6.25F, 30.0F, kNan};
  p.kind = {PointKind::canopy, PointKind::canopy, PointKind::wood};
  return p;
}

std::string written(PointCloudFormat format, int times = 1) {
  const TemporaryFolder folder;
  auto writer = PointCloudWriter::create(folder / "cloud", format, options());
  if (!writer) return writer.error().line();
  for (int i = 0; i < times; ++i) EXPECT_TRUE(writer->write(three_points()));
  EXPECT_TRUE(folder.names().empty() || read_file(folder / "cloud").empty()) << "it appears when it is complete";
  EXPECT_TRUE(writer->close());
  return read_file(folder / "cloud");
}

template <class T>
T at(const std::string& bytes, std::size_t offset) {
  T value{};
  if (offset + sizeof(T) <= bytes.size()) std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

// Offsets and values are those of LAS 1.4 R15, tables 3 (header), 7 (variable length records), 16 (format 7) and 24
// (extra bytes).
TEST(LasPointCloud, HasTheHeaderOfTheSpecification) {
  const std::string las = written(PointCloudFormat::las);
  EXPECT_EQ(las.substr(0, 4), "LASF");
  EXPECT_EQ(at<std::uint16_t>(las, 6), 0b10001) << "adjusted standard GPS time, WKT";
  EXPECT_EQ(at<std::uint8_t>(las, 24), 1);
  EXPECT_EQ(at<std::uint8_t>(las, 25), 4);
  EXPECT_EQ(at<std::uint16_t>(las, 90), 42) << "11 February";
  EXPECT_EQ(at<std::uint16_t>(las, 92), 2019);
  EXPECT_EQ(at<std::uint16_t>(las, 94), 375);
  EXPECT_EQ(at<std::uint32_t>(las, 100), 2U);
  EXPECT_EQ(at<std::uint8_t>(las, 104), 7);
  EXPECT_EQ(at<std::uint16_t>(las, 105), 40);
  EXPECT_EQ(at<std::uint32_t>(las, 107), 0U) << "the count of older versions";
  EXPECT_EQ(at<std::uint32_t>(las, 111), 0U);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(at<double>(las, 131 + 8 * k), 1e-4);
  EXPECT_EQ(at<double>(las, 155), 276500);
  EXPECT_EQ(at<double>(las, 163), 6099800);
  const double bounds[6] = {276543.1234, 276499.9999, 6099900.25, 6099799.5, 84.75, 80.0001};
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(at<double>(las, 179 + 8 * k), bounds[k], 1e-8) << k;
  EXPECT_EQ(at<std::uint64_t>(las, 227), 0U);
  EXPECT_EQ(at<std::uint64_t>(las, 247), 3U);
  EXPECT_EQ(at<std::uint64_t>(las, 255), 3U) << "first returns";
  EXPECT_EQ(at<std::uint64_t>(las, 263), 0U);
  EXPECT_EQ(las.size(), at<std::uint32_t>(las, 96) + 3 * 40);
}

TEST(LasPointCloud, NamesTheCrsAndDescribesTheDensity) {
  const std::string las = written(PointCloudFormat::las);
  EXPECT_EQ(las.substr(375 + 2, 15), "LASF_Projection");
  EXPECT_EQ(at<std::uint16_t>(las, 375 + 18), 2112);
  const std::size_t length = at<std::uint16_t>(las, 375 + 20);
  const std::string wkt = las.substr(375 + 54, length);
  EXPECT_THAT(wkt, HasSubstr("PROJCS[\"GDA2020 / MGA zone 54\""));
  EXPECT_THAT(wkt, HasSubstr("AUTHORITY[\"EPSG\",\"7854\"]]"));
  EXPECT_EQ(wkt.back(), '\0');
  const std::size_t extra = 375 + 54 + length;
  EXPECT_EQ(las.substr(extra + 2, 9), "LASF_Spec");
  EXPECT_EQ(at<std::uint16_t>(las, extra + 18), 4);
  EXPECT_EQ(at<std::uint16_t>(las, extra + 20), 192);
  EXPECT_EQ(at<std::uint8_t>(las, extra + 54 + 2), 9) << "float";
  EXPECT_EQ(las.substr(extra + 54 + 4, 8), std::string("density\0", 8));
  EXPECT_THAT(las.substr(extra + 54 + 160, 32), HasSubstr("m2/m3"));
  EXPECT_EQ(at<std::uint32_t>(las, 96), extra + 54 + 192) << "where the points begin";
}

TEST(LasPointCloud, HoldsThePoints) {
  const std::string las = written(PointCloudFormat::las);
  const std::size_t first = at<std::uint32_t>(las, 96);
  const DensityPoints points = three_points();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t point = first + 40 * i;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(at<std::int32_t>(las, point + 4 * static_cast<std::size_t>(k)) * 1e-4 + options().offset_m[k],
                  points.position[i][k], 1e-8);
    EXPECT_EQ(at<std::uint16_t>(las, point + 12), points.intensity[i]);
    EXPECT_EQ(at<std::uint8_t>(las, point + 14), 0x11) << "return 1 of 1";
    EXPECT_EQ(at<std::uint8_t>(las, point + 16), i == 2 ? 64 : 5);
    // 1549843200 is 2019-02-11T00:00:00Z, 18 leap seconds after GPS began: 1233878418 s of GPS.
    EXPECT_EQ(at<double>(las, point + 22), 233878418 + (points.time_s[i] - 1549843200));
    const Rgba color = i == 2 ? Rgba{150, 150, 150, 255} : color_at(kScale, static_cast<double>(points.density[i]));
    EXPECT_EQ(at<std::uint16_t>(las, point + 30), 256 * color.r);
    EXPECT_EQ(at<std::uint16_t>(las, point + 32), 256 * color.g);
    EXPECT_EQ(at<std::uint16_t>(las, point + 34), 256 * color.b);
    const auto density = at<float>(las, point + 36);
    EXPECT_TRUE(i == 2 ? std::isnan(density) : density == points.density[i]);
  }
}

TEST(LasPointCloud, APointFarFromItsOffsetIsRefused) {
  const TemporaryFolder folder;
  PointCloudOptions far = options();
  far.offset_m.x() = 0;
  auto writer = PointCloudWriter::create(folder / "c.las", PointCloudFormat::las, far);
  ASSERT_TRUE(writer) << writer.error().line();
  const auto result = writer->write(three_points());
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::bad_input);
}

TEST(PlyPointCloud, SaysWhatItHoldsAndHoldsIt) {
  const std::string ply = written(PointCloudFormat::ply, 2);
  const std::size_t first = ply.find("end_header\n") + 11;
  const std::string header = ply.substr(0, first);
  EXPECT_THAT(header, HasSubstr("format binary_little_endian 1.0\n"));
  EXPECT_THAT(header, HasSubstr("comment crs EPSG:7854\n"));
  EXPECT_THAT(header, HasSubstr("element vertex 6\nproperty double x\nproperty double y\nproperty double z\n"
                                "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                                "property float density\nproperty ushort intensity\nproperty uchar classification\n"
                                "property double time\nend_header\n"));
  ASSERT_EQ(ply.size(), first + 6 * 42);
  const DensityPoints points = three_points();
  for (std::size_t i = 0; i < 6; ++i) {
    const std::size_t point = first + 42 * i, from = i % 3;
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(at<double>(ply, point + 8 * k), points.position[from][static_cast<Eigen::Index>(k)]);
    const auto density = at<float>(ply, point + 27);
    EXPECT_TRUE(from == 2 ? std::isnan(density) : density == points.density[from]);
    EXPECT_EQ(at<std::uint16_t>(ply, point + 31), points.intensity[from]);
    EXPECT_EQ(at<std::uint8_t>(ply, point + 33), from == 2 ? 64 : 5);
    EXPECT_EQ(at<double>(ply, point + 34), points.time_s[from]);
  }
  EXPECT_EQ(at<std::uint8_t>(ply, first + 24), color_at(kScale, 6.25).r);
}

TEST(PointCloud, RepeatsByteForByteAndMayBeEmpty) {
  for (const PointCloudFormat format : {PointCloudFormat::las, PointCloudFormat::ply}) {
    EXPECT_TRUE(written(format, 3) == written(format, 3));
    EXPECT_GT(written(format, 0).size(), 100U);
  }
  EXPECT_EQ(at<std::uint64_t>(written(PointCloudFormat::las, 0), 247), 0U);
}

TEST(PointCloud, WrongInputIsRefused) {
  const TemporaryFolder folder;
  const auto code = [&](const std::string& path, PointCloudFormat format, const PointCloudOptions& with) {
    const auto writer = PointCloudWriter::create(path, format, with);
    return writer ? ErrorCode{} : writer.error().code;
  };
  PointCloudOptions bad = options();
  bad.crs = "EPSG:999999";
  EXPECT_EQ(code(folder / "c.las", PointCloudFormat::las, bad), ErrorCode::usage);
  bad = options(), bad.date = "yesterday";
  EXPECT_EQ(code(folder / "c.las", PointCloudFormat::las, bad), ErrorCode::usage);
  bad = options(), bad.scale.high = bad.scale.low;
  EXPECT_EQ(code(folder / "c.ply", PointCloudFormat::ply, bad), ErrorCode::usage);
  auto writer = PointCloudWriter::create(folder / "c.ply", PointCloudFormat::ply, options());
  DensityPoints points = three_points();
  points.position[1].x() = std::nan("");
  EXPECT_EQ(writer->write(points).error().code, ErrorCode::bad_input);
}

}  // namespace
}  // namespace rayfield::formats
