#include "rayfield/formats/ply_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/formats/ply_support.h"

namespace rayfield::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

RayBatch three_rays() {
  RayBatch batch;
  // MGA coordinates: six digits before and six behind the point, which float could not hold.
  batch.push({276543.123456, 6099876.654321, 82.5}, {276550.000001, 6099870.000002, 80.000003}, 1549843200.0123456, 80,
             true);
  batch.push({276543.25, 6099876.5, 82.5}, {276543.25, 6099876.5, 122.5}, 1549843200.02, 0, false);
  batch.push({276543.25, 6099876.5, 82.5}, {276544.25, 6099876.5, 82.5}, 1549843200.03, 60000, true);
  return batch;
}

TEST(PlyWriter, WritesWhatTheReaderGetsBack) {
  const TemporaryFile file("", ".ply");
  PlyWriteOptions options;
  options.crs = "EPSG:7854";
  options.beam = LidarBeam{0.0136, 0.0119, std::nullopt};
  auto writer = PlyWriter::create(file.path(), options);
  ASSERT_TRUE(writer) << writer.error().line();
  const RayBatch rays = three_rays();
  ASSERT_TRUE(writer->write(rays));
  ASSERT_TRUE(writer->write(RayBatch()));
  ASSERT_TRUE(writer->write(rays));
  ASSERT_TRUE(writer->close());
  const auto reader = PlyReader::open(file.path());
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_EQ((*reader)->crs(), "EPSG:7854");
  EXPECT_EQ((*reader)->beam(), options.beam);
  const ReadCloud cloud = read_all(read_file(file.path()));
  ASSERT_EQ(cloud.rays.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(cloud.rays.end[i], rays.end[i % 3]);
    EXPECT_EQ(cloud.rays.time_s[i], rays.time_s[i % 3]);
    // The start is kept as a float vector: 40 m have a spacing of 4 µm.
    EXPECT_LT((cloud.rays.origin[i] - rays.origin[i % 3]).norm(), 4e-6);
    EXPECT_EQ(cloud.rays.hit[i], rays.hit[i % 3]);
  }
  EXPECT_THAT(cloud.rays.intensity, ElementsAre(80, 0, 255, 80, 0, 255));
  EXPECT_TRUE(cloud.warnings.empty());
}

TEST(PlyWriter, WritesTheHeaderThatRaycloudtoolsExpects) {
  const TemporaryFile file("", ".ply");
  auto writer = PlyWriter::create(file.path());
  ASSERT_TRUE(writer->write(three_rays()));
  ASSERT_TRUE(writer->close());
  const std::string content = read_file(file.path());
  const std::size_t end = content.find("end_header\n") + 11;
  EXPECT_EQ(content.size() - end, 3U * 48U);
  const std::string header = content.substr(0, end);
  EXPECT_THAT(header, HasSubstr("\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(header, HasSubstr("\nelement vertex 3\n" + std::string(kStandardProperties) + "end_header\n"));
  // raycloudtools takes any line with these words, comments too, for the column.
  EXPECT_EQ(header.find("time"), header.rfind("time"));
  EXPECT_EQ(header.find("intensity"), std::string::npos);
}

TEST(PlyWriter, WritesAnEmptyCloud) {
  const TemporaryFile file("", ".ply");
  auto writer = PlyWriter::create(file.path());
  ASSERT_TRUE(writer->close());
  EXPECT_EQ(read_all(read_file(file.path())).rays.size(), 0U);
}

TEST(PlyWriter, LeavesNothingBehindWithoutClose) {
  const TemporaryFile file("before", ".ply");
  {
    auto writer = PlyWriter::create(file.path());
    ASSERT_TRUE(writer->write(three_rays()));
  }
  EXPECT_EQ(read_file(file.path()), "before");
}

TEST(PlyWriter, RefusesWhatItCannotWrite) {
  EXPECT_FALSE(PlyWriter::create("/nonexistent/folder/x.ply"));
  const TemporaryFile file("", ".ply");
  for (const char* crs : {"EPSG:1 2", "time", "property", "a\nb"}) {
    EXPECT_EQ(PlyWriter::create(file.path(), {crs}).error().code, ErrorCode::usage) << crs;
  }
  auto writer = PlyWriter::create(file.path());
  RayBatch rays = three_rays();
  rays.end[1].x() = kNaN;
  EXPECT_THAT(writer->write(rays).error().line(), HasSubstr("ray 1"));
}

}  // namespace
}  // namespace rayfield::formats
