#include "rayfield/formats/ply_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/formats/ply_support.h"

namespace rayfield::formats {
namespace {

using namespace bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string ply_header(const std::string& count, const std::string& properties,
                       const std::string& format = "binary_little_endian") {
  return "ply\nformat " + format + " 1.0\ncomment made by hand\nelement vertex " + count + "\n" + properties +
         "end_header\n";
}

/// A row of the standard layout: the ray from origin to end.
std::string row(const Eigen::Vector3d& origin, const Eigen::Vector3d& end, double time_s, int alpha) {
  const Eigen::Vector3d back = origin - end;
  return doubles({end.x(), end.y(), end.z(), time_s}) + floats({back.x(), back.y(), back.z()}) + u8(1) + u8(2) + u8(3) +
         u8(alpha);
}

Error open_error(const std::string& content) {
  const TemporaryFile file(content, ".ply");
  const auto reader = PlyReader::open(file.path());
  if (reader) ADD_FAILURE() << "the file was opened";
  return reader ? Error{} : reader.error();
}

TEST(PlyReader, ReadsTheStandardLayoutOfRaycloudtools) {
  const ReadCloud cloud = read_all(ply_header("2", kStandardProperties) + row({1, 2, 3}, {1, 2, 7}, 100.25, 200) +
                                   row({1, 2, 3}, {41, 2, 3}, 100.5, 0));
  ASSERT_EQ(cloud.rays.size(), 2U);
  EXPECT_EQ(cloud.rays.origin[0], Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(cloud.rays.end[0], Eigen::Vector3d(1, 2, 7));
  EXPECT_EQ(cloud.rays.time_s[0], 100.25);
  EXPECT_THAT(cloud.rays.intensity, ElementsAre(200, 0));
  EXPECT_THAT(cloud.rays.hit, ElementsAre(1, 0));
  EXPECT_EQ(cloud.rays.origin[1], Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(cloud.warnings.empty());
}

TEST(PlyReader, FollowsTheHeaderInOrderTypesAndLineEnds) {
  // alpha first, coordinates as float, ray starts as double, time as float, properties that nobody needs in between;
  // Windows line ends; the zero-padded count that raycloudtools writes.
  std::string header = ply_header("0000000000000000001",
                                  "property uchar alpha\nproperty short ring\nproperty float x\nproperty float y\n"
                                  "property float z\nproperty int label\nproperty float time\nproperty double nx\n"
                                  "property double ny\nproperty double nz\n");
  for (std::size_t at = 0; (at = header.find('\n', at)) != std::string::npos; at += 2) header.insert(at, "\r");
  const ReadCloud cloud = read_all(header + u8(7) + le(std::int16_t{-3}) + floats({1.5, 2.5, 3.5}) + u32(99) +
                                   f32(12.5) + doubles({-1, 0.25, 4}));
  ASSERT_EQ(cloud.rays.size(), 1U);
  EXPECT_EQ(cloud.rays.end[0], Eigen::Vector3d(1.5, 2.5, 3.5));
  EXPECT_EQ(cloud.rays.origin[0], Eigen::Vector3d(0.5, 2.75, 7.5));
  EXPECT_EQ(cloud.rays.time_s[0], 12.5);
  EXPECT_EQ(cloud.rays.intensity[0], 7);
  EXPECT_THAT(cloud.warnings, ElementsAre(HasSubstr("times are float")));
}

TEST(PlyReader, ReadsRayStartsUnderTheirOtherName) {
  const ReadCloud cloud =
      read_all(ply_header("1",
                          "property double x\nproperty double y\nproperty double z\nproperty double time\n"
                          "property float rayx\nproperty float rayy\nproperty float rayz\n") +
               doubles({1, 1, 1, 5}) + floats({0, 0, 2}));
  ASSERT_EQ(cloud.rays.size(), 1U);
  EXPECT_EQ(cloud.rays.origin[0], Eigen::Vector3d(1, 1, 3));
  EXPECT_EQ(cloud.rays.hit[0], 1);
  EXPECT_THAT(cloud.warnings, ElementsAre(HasSubstr("no alpha")));
}

TEST(PlyReader, DropsAndCountsRaysThatAreNone) {
  const double nan = kNaN, inf = kInfinity;
  const ReadCloud cloud = read_all(ply_header("7", kStandardProperties) + row({0, 0, 0}, {nan, 0, 0}, 1, 1) +
                                   row({0, 0, inf}, {0, 0, 0}, 1, 1) + row({0, 0, 0}, {1, 0, 0}, nan, 1) +
                                   row({5, 5, 5}, {5, 5, 5}, 1, 1) + row({0, 0, 0}, {2e8, 0, 0}, 1, 1) +
                                   row({0, 0, 0}, {1, 0, 0}, 1, 9) + row({0, 0, 0}, {-inf, 0, 0}, 1, 1));
  EXPECT_THAT(cloud.rays.intensity, ElementsAre(9));
  EXPECT_THAT(cloud.warnings,
              ElementsAre("4 rays with NaN or infinite values dropped",
                          "1 rays with coordinates beyond 100000 km dropped", "1 rays of zero length dropped"));
}

TEST(PlyReader, ReadsInBatchesAndAgain) {
  std::string content = ply_header("100", kStandardProperties);
  for (int i = 0; i < 100; ++i) content += row({0, 0, 0}, {1, 0, i == 50 ? std::nan("") : 1.0 * i}, i, 1);
  const TemporaryFile file(content, ".ply");
  auto reader = PlyReader::open(file.path());
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_EQ((*reader)->ray_count(), 100U);
  for (int pass = 0; pass < 2; ++pass) {
    RayBatch batch;
    std::vector<double> times;
    for (std::size_t got = 1; got > 0; times.insert(times.end(), batch.time_s.begin(), batch.time_s.end())) {
      got = *(*reader)->read(batch, 7);
      EXPECT_LE(got, 7U);
    }
    ASSERT_EQ(times.size(), 99U);
    EXPECT_EQ(times.front(), 0.0);
    EXPECT_EQ(times.back(), 99.0);
    EXPECT_THAT((*reader)->warnings(), ElementsAre(HasSubstr("1 rays with NaN")));
    EXPECT_TRUE(*(*reader)->rewind());
  }
}

TEST(PlyReader, StopsAmidRaysThatAreAllDropped) {
  constexpr std::size_t kRays = 100000;  // 4.8 MB
  std::string content = ply_header(std::to_string(kRays), kStandardProperties);
  const std::string none = row({5, 5, 5}, {5, 5, 5}, 1, 1);
  for (std::size_t i = 0; i < kRays; ++i) content += none;
  const TemporaryFile file(content, ".ply");
  int asked = 0;
  auto reader = PlyReader::open(file.path(), {.cancelled = [&asked] { return ++asked == 3; }});
  ASSERT_TRUE(reader) << reader.error().line();
  RayBatch batch;
  const auto read = (*reader)->read(batch, 7);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::interrupted);
  EXPECT_EQ(asked, 3);
}

TEST(PlyReader, SaysHowManyRaysOfATruncatedFileAreComplete) {
  const std::string whole = ply_header("3", kStandardProperties) + row({0, 0, 0}, {1, 0, 0}, 1, 1) +
                            row({0, 0, 0}, {2, 0, 0}, 2, 1) + row({0, 0, 0}, {3, 0, 0}, 3, 1);
  const std::string cut = whole.substr(0, whole.size() - 1);
  EXPECT_EQ(open_error(cut).code, ErrorCode::bad_input);
  EXPECT_THAT(open_error(cut).line(), HasSubstr("announces 3 rays, 2 are complete"));
  PlyReadOptions options;
  options.allow_truncated = true;
  const ReadCloud cloud = read_all(cut, options);
  EXPECT_THAT(cloud.rays.time_s, ElementsAre(1, 2));
  EXPECT_THAT(cloud.warnings, ElementsAre(HasSubstr("announces 3 rays, 2 are complete")));
}

TEST(PlyReader, DoesNotIgnoreBytesBehindTheLastRay) {
  const std::string content =
      ply_header("1", kStandardProperties) + row({0, 0, 0}, {1, 0, 0}, 1, 1) + row({0, 0, 0}, {2, 0, 0}, 2, 1);
  EXPECT_THAT(open_error(content).line(), HasSubstr("48 bytes follow the 1 rays"));
  PlyReadOptions options;
  options.allow_trailing = true;
  EXPECT_THAT(read_all(content, options).rays.time_s, ElementsAre(1));
}

TEST(PlyReader, RefusesWhatIsNoRayCloudWithTheReason) {
  const auto with = [](const std::string& properties) { return ply_header("0", properties); };
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string starts = "property float nx\nproperty float ny\nproperty float nz\n";
  EXPECT_THAT(open_error("").line(), HasSubstr("the file is empty"));
  EXPECT_THAT(open_error("LASF").line(), HasSubstr("not a PLY file"));
  EXPECT_THAT(open_error("plyx\nformat ascii 1.0\n").line(), HasSubstr("not a PLY file"));
  EXPECT_THAT(open_error(ply_header("1", kStandardProperties, "ascii")).line(),
              HasSubstr("ASCII PLY is not supported"));
  EXPECT_THAT(open_error(ply_header("1", kStandardProperties, "binary_big_endian")).line(), HasSubstr("big-endian"));
  EXPECT_THAT(open_error(ply_header("1", kStandardProperties, "binary_middle_endian")).line(),
              HasSubstr("unknown PLY"));
  EXPECT_THAT(open_error("ply\nformat binary_little_endian 1.0\nend_header\n").line(), HasSubstr("no element vertex"));
  EXPECT_THAT(open_error("ply\nelement vertex 0\nend_header\n").line(), HasSubstr("format line is missing"));
  EXPECT_THAT(open_error("ply\nformat binary_little_endian 1.0\nelement vertex 1\n").line(),
              HasSubstr("no end_header"));
  EXPECT_THAT(open_error(with(xyz + "property double time\n")).line(), HasSubstr("point cloud without ray starts"));
  EXPECT_THAT(open_error(with(xyz + starts)).line(), HasSubstr("no time"));
  EXPECT_THAT(open_error(with(starts + "property double time\n")).line(), HasSubstr("no coordinates"));
  EXPECT_THAT(open_error(with("property list uchar int vertex_indices\n")).line(), HasSubstr("lists"));
  EXPECT_THAT(open_error(with("property half x\n")).line(), HasSubstr("unknown type 'half'"));
  EXPECT_THAT(open_error(with(xyz + "property float x\n")).line(), HasSubstr("a second property 'x'"));
  EXPECT_THAT(open_error(with(xyz + starts + "property double time\nproperty float alpha\n")).line(),
              HasSubstr("alpha is not of type uchar"));
  EXPECT_THAT(open_error(ply_header("-1", kStandardProperties)).line(), HasSubstr("header line 4"));
  EXPECT_THAT(open_error(ply_header("99999999999999999999999", kStandardProperties)).line(),
              HasSubstr("header line 4"));
  EXPECT_THAT(open_error(ply_header("18446744073709551615", kStandardProperties)).line(), HasSubstr("truncated"));
}

TEST(PlyReader, RefusesTheSharedPlyFilesThatAreNoRayClouds) {
  const std::string folder = shared_folder();
  if (folder.empty()) GTEST_SKIP() << "the shared test data are not here; set RAYFIELD_SHARED";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder + "/ply")) {
    const auto reader = PlyReader::open(entry.path().string());
    ASSERT_FALSE(reader) << entry.path();
    EXPECT_EQ(reader.error().code, ErrorCode::bad_input);
    const bool ascii = entry.path().filename() != "simple_binary.ply";
    EXPECT_THAT(reader.error().line(), HasSubstr(ascii ? "ASCII" : "point cloud without ray starts")) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 9);
}

}  // namespace
}  // namespace rayfield::formats
