#include "rayfield/formats/las_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/las/las_crs.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/formats/las_info.h"
#include "tests/formats/las_support.h"

namespace rayfield::formats {
namespace {

using namespace bytes;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kDrive_s = 1625097600;  // 2021-07-01, Unix
constexpr double kAdjusted_s = kDrive_s - 1315964800 + 18;
const Eigen::Vector3d kPlace(276000, 6099000, 80);

// Along east at 1 m/s for a minute, 10 poses a second.
std::shared_ptr<TrajectoryFile> drive() {
  auto trajectory = std::make_shared<TrajectoryFile>();
  for (int i = 0; i <= 600; ++i)
    trajectory->poses.push_back(
        {kDrive_s + 0.1 * i, {Eigen::Quaterniond::Identity(), kPlace + Eigen::Vector3d(0.1 * i, 0, 2)}});
  return trajectory;
}

// `count` points, 3 m north of the vehicle, every half second.
LasSpec spec_of(int minor, int format, int count = 3) {
  LasSpec spec;
  spec.minor = minor, spec.format = format, spec.offset = kPlace;
  for (int i = 0; i < count; ++i) {
    LasTestPoint point;
    point.position = kPlace + Eigen::Vector3d(0.5 * i, 3, 1), point.time_s = kAdjusted_s + 0.5 * i;
    point.intensity = 1000 + i;
    spec.points.push_back(point);
  }
  return spec;
}

Result<std::unique_ptr<LasReader>> open(const TemporaryFile& file, const LasReadOptions& options = {}) {
  return LasReader::open(file.path(), drive(), options);
}

Error open_error(const std::string& content, const LasReadOptions& options = {}) {
  const TemporaryFile file(content, ".las");
  const auto reader = open(file, options);
  if (reader) ADD_FAILURE() << "the file was opened";
  return reader ? Error{} : reader.error();
}

struct ReadCloud {
  RayBatch rays;
  std::vector<std::string> warnings;
};

ReadCloud read_all(const std::string& content, const LasReadOptions& options = {}) {
  const TemporaryFile file(content, ".las");
  ReadCloud out;
  const auto reader = open(file, options);
  if (!reader) {
    ADD_FAILURE() << reader.error().line();
    return out;
  }
  EXPECT_TRUE((*reader)->read(out.rays, 1000));
  out.warnings = (*reader)->warnings();
  return out;
}

TEST(LasReader, ReadsEveryVersionAndFormatThatHasTimes) {
  const std::vector<std::pair<int, std::vector<int>>> versions = {
      {2, {1, 3}}, {3, {1, 3, 4, 5}}, {4, {1, 3, 4, 5, 6, 7, 8, 9, 10}}};
  for (const auto& [minor, formats] : versions)
    for (const int format : formats)
      for (const int extra : {0, 5}) {
        LasSpec spec = spec_of(minor, format);
        spec.extra_bytes = extra;
        const ReadCloud cloud = read_all(las_bytes(spec));
        ASSERT_EQ(cloud.rays.size(), 3U) << "LAS 1." << minor << ", format " << format;
        EXPECT_LT((cloud.rays.end[2] - spec.points[2].position).norm(), 1e-9);
        EXPECT_LT((cloud.rays.origin[2] - kPlace - Eigen::Vector3d(1, 0, 2)).norm(), 1e-6);
        EXPECT_NEAR(cloud.rays.time_s[2], kDrive_s + 1, 1e-6);
        EXPECT_THAT(cloud.rays.intensity, ElementsAre(1000, 1001, 1002));
        EXPECT_THAT(cloud.rays.hit, Each(1));
        EXPECT_THAT(cloud.warnings, IsEmpty());
      }
}

TEST(LasReader, LeavesOutAndCountsWhatIsNoEndOfARay) {
  for (const int format : {1, 6}) {
    LasSpec spec = spec_of(4, format, 9);
    spec.points[0].return_number = 2, spec.points[0].returns = 2;
    spec.points[1].withheld = true;
    spec.points[2].synthetic = true;
    spec.points[3].classification = 7;
    spec.points[4].classification = 18;
    spec.points[5].time_s = kNaN;
    spec.points[6].time_s = kAdjusted_s + 100;
    spec.points[7].return_number = 0, spec.points[7].intensity = 0;  // writers that know no returns
    spec.points[8].position = kPlace + Eigen::Vector3d(4, 0, 2);     // where the sensor stands
    const ReadCloud cloud = read_all(las_bytes(spec));
    ASSERT_EQ(cloud.rays.size(), 1U);
    EXPECT_EQ(cloud.rays.intensity[0], 1) << "0 means no hit";
    EXPECT_THAT(cloud.warnings,
                ElementsAre("1 points that are later returns of their pulse left out",
                            "1 points flagged as withheld left out", "1 points flagged as synthetic left out",
                            "2 points classified as noise left out", "1 points with NaN or infinite times left out",
                            "1 points measured before or after the trajectory left out",
                            "1 points at the sensor itself left out"));
  }
}

TEST(LasReader, LeavesOutPointsInGapsOfTheTrajectory) {
  const TemporaryFile file(las_bytes(spec_of(4, 6, 60)), ".las");
  auto with_gap = drive();
  with_gap->poses.erase(with_gap->poses.begin() + 101, with_gap->poses.begin() + 200);  // 10.0 to 20.0 s
  const auto reader = LasReader::open(file.path(), with_gap);
  ASSERT_TRUE(reader) << reader.error().line();
  RayBatch batch;
  EXPECT_EQ((*reader)->read(batch, 1000).value(), 41U);
  EXPECT_THAT((*reader)->warnings(), ElementsAre("19 points measured in gaps of the trajectory left out"));
}

TEST(LasReader, AddsTheTimeOffsetAndTheLeverArm) {
  const LasReadOptions options{.lever_arm_m = {0, 0.5, 0.25}, .time_offset_s = 0.2};
  const ReadCloud cloud = read_all(las_bytes(spec_of(4, 6)), options);
  ASSERT_EQ(cloud.rays.size(), 3U);
  EXPECT_LT((cloud.rays.origin[0] - kPlace - Eigen::Vector3d(0.2, 0.5, 2.25)).norm(), 1e-6);
  EXPECT_NEAR(cloud.rays.time_s[0], kDrive_s + 0.2, 1e-6);
  const TemporaryFile file(las_bytes(spec_of(4, 6)), ".las");
  auto without = drive();
  without->has_orientation = false;
  EXPECT_EQ(LasReader::open(file.path(), without, options).error().code, ErrorCode::usage);
  EXPECT_EQ(LasReader::open(file.path(), without, {.max_gap_s = -1}).error().code, ErrorCode::usage);
  EXPECT_EQ(LasReader::open(file.path(), nullptr).error().code, ErrorCode::usage);
  without->poses.resize(1);
  EXPECT_THAT(LasReader::open(file.path(), without).error().line(), HasSubstr("fewer than two poses"));
}

TEST(LasReader, ReadsInBatchesAndAgain) {
  LasSpec spec = spec_of(4, 6, 100);
  spec.points[50].withheld = true;
  const TemporaryFile file(las_bytes(spec), ".las");
  const auto reader = open(file);
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_EQ((*reader)->ray_count(), 100U);
  for (int pass = 0; pass < 2; ++pass) {
    RayBatch batch;
    std::size_t rays = 0;
    for (std::size_t got = 1; got > 0; rays += got) {
      got = (*reader)->read(batch, 7).value();
      EXPECT_LE(got, 7U);
    }
    EXPECT_EQ(rays, 99U);
    EXPECT_THAT((*reader)->warnings(), ElementsAre("1 points flagged as withheld left out"));
    EXPECT_TRUE((*reader)->rewind().value());
  }
}

TEST(LasReader, StopsAmidPointsThatAreAllLeftOut) {
  LasSpec spec = spec_of(4, 6, 1);
  std::string content = las_bytes(spec);
  LasTestPoint withheld = spec.points[0];
  withheld.withheld = true;
  constexpr std::uint64_t kPoints = 100000;  // 3 MB
  const std::string record = las_point(spec, withheld);
  for (std::uint64_t i = 1; i < kPoints; ++i) content += record;
  content = patched(content, 247, u64(kPoints));
  const TemporaryFile file(content, ".las");
  int asked = 0;
  const auto reader = open(file, {.cancelled = [&asked] { return ++asked == 3; }});
  ASSERT_TRUE(reader) << reader.error().line();
  RayBatch batch;
  const auto read = (*reader)->read(batch, kPoints);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::interrupted);
}

TEST(LasReader, SaysHowManyPointsOfATruncatedFileAreComplete) {
  const std::string whole = las_bytes(spec_of(4, 6));
  const std::string cut = whole.substr(0, whole.size() - 1);
  EXPECT_EQ(open_error(cut).code, ErrorCode::bad_input);
  EXPECT_THAT(open_error(cut).line(),
              HasSubstr("at byte 464: the file is truncated: its header announces 3 points, 2 are"));
  const ReadCloud cloud = read_all(cut, {.allow_truncated = true});
  EXPECT_EQ(cloud.rays.size(), 2U);
  EXPECT_THAT(cloud.warnings, ElementsAre(HasSubstr("announces 3 points, 2 are complete")));
  EXPECT_THAT(open_error(whole.substr(0, 375), {.allow_truncated = true}).line(), HasSubstr("it holds no points"));
}

TEST(LasReader, DoesNotIgnoreBytesBehindTheLastPointThatNothingAnnounces) {
  const std::string content = las_bytes(spec_of(2, 1)) + "more";
  EXPECT_THAT(open_error(content).line(), HasSubstr("at byte 311: 4 bytes follow the 3 points"));
  EXPECT_EQ(read_all(content, {.allow_trailing = true}).rays.size(), 3U);
  // Waveforms inside the file, behind the points.
  EXPECT_EQ(read_all(patched(las_bytes(spec_of(3, 4)), 227, u64(406)) + "waves").rays.size(), 3U);
}

TEST(LasReader, FindsTheCrsInWktOrGeoTiffKeysWhereverTheyStand) {
  const std::string wkt = lookup_projected_crs("EPSG:7854").value().wkt;
  const std::string named = las_record("LASF_Projection", 2112, wkt + '\0');
  const std::string keys = geokeys({{1024, 0, 1, 1}, {3072, 0, 1, 28354}});
  const auto crs_of = [](LasSpec spec) {
    const TemporaryFile file(las_bytes(spec), ".las");
    const auto reader = open(file);
    EXPECT_TRUE(reader) << reader.error().line();
    return reader ? (*reader)->crs().value_or("none") : "";
  };
  LasSpec spec = spec_of(4, 6);
  EXPECT_EQ(crs_of(spec), "none");
  spec.records = {las_record("other", 2112, "x"), named, keys};
  EXPECT_EQ(crs_of(spec), "EPSG:28354") << "bit 4 says GeoTIFF keys";
  spec.encoding = 17;
  EXPECT_EQ(crs_of(spec), "EPSG:7854");
  spec.records = {}, spec.extended_count = 1;
  spec.extended = extended_las_record("LASF_Projection", 2112, wkt);
  EXPECT_EQ(crs_of(spec), "EPSG:7854");
  spec = spec_of(2, 1);
  spec.records = {geokeys({{1024, 0, 1, 2}, {2048, 0, 1, 4326}})};
  EXPECT_EQ(crs_of(spec), "EPSG:4326");
  spec.records = {geokeys({{1024, 0, 1, 1}, {3072, 0, 1, 32767}})};
  EXPECT_EQ(crs_of(spec), "none");
  EXPECT_THAT(read_all(las_bytes(spec)).warnings, ElementsAre(HasSubstr("name no CRS by code")));
}

TEST(LasReader, KeepsTheWktOfACrsWithoutCodeAndItsNameForPeople) {
  LasSpec spec = spec_of(4, 6);
  spec.encoding = 17;
  spec.records = {las_record("LASF_Projection", 2112, "LOCAL_CS[\"the farm's own grid\",UNIT[\"metre\",1]]")};
  const TemporaryFile file(las_bytes(spec), ".las");
  const auto reader = open(file);
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_THAT((*reader)->crs().value_or(""), HasSubstr("LOCAL_CS["));
  EXPECT_EQ((*reader)->crs_name(), "the farm's own grid");
  EXPECT_FALSE(same_crs(*(*reader)->crs(), "EPSG:7854"));
}

TEST(LasReader, NamesTheCrsOfOtherSoftwareSoThatItIsRecognised) {
  const auto crs_of = [](const std::string& wkt) {
    LasSpec spec = spec_of(4, 6);
    spec.encoding = 17;
    spec.records = {las_record("LASF_Projection", 2112, wkt + '\0')};
    const TemporaryFile file(las_bytes(spec), ".las");
    return open(file).value()->crs().value_or("");
  };
  // As Esri's software writes it, without codes.
  const auto esri = [](const std::string& zone, const std::string& meridian) {
    return "PROJCS[\"WGS_1984_UTM_Zone_" + zone +
           "\",GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\",SPHEROID[\"WGS_1984\",6378137.0,298.257223563]],"
           "PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],"
           "PARAMETER[\"False_Easting\",500000.0],PARAMETER[\"False_Northing\",0.0],PARAMETER[\"Central_Meridian\"," +
           meridian + "],PARAMETER[\"Scale_Factor\",0.9996],PARAMETER[\"Latitude_Of_Origin\",0.0],UNIT[\"Meter\",1.0]]";
  };
  EXPECT_TRUE(same_crs(crs_of(esri("32N", "9.0")), "EPSG:32632"));
  EXPECT_FALSE(same_crs(crs_of(esri("33N", "15.0")), "EPSG:32632"));
  const std::string height =
      "VERT_CS[\"EGM2008 height\",VERT_DATUM[\"EGM2008 geoid\",2005],UNIT[\"metre\",1],AXIS[\"Gravity-related "
      "height\",UP]]";
  EXPECT_TRUE(same_crs(crs_of("COMPD_CS[\"both\"," + esri("32N", "9.0") + "," + height + "]"), "EPSG:32632"));
}

TEST(LasReader, RefusesWhatItDoesNotReadWithTheReason) {
  const std::string good = las_bytes(spec_of(2, 1)), newest = las_bytes(spec_of(4, 6));
  EXPECT_THAT(open_error("").line(), HasSubstr("the file is empty"));
  EXPECT_THAT(open_error("ply\n").line(), HasSubstr("not a LAS file"));
  EXPECT_THAT(open_error(good.substr(0, 100)).line(), HasSubstr("header at byte 100: the file ends in its header"));
  EXPECT_THAT(open_error(newest.substr(0, 300)).line(), HasSubstr("header at byte 300: the file ends in its header"));
  EXPECT_THAT(open_error(patched(good, 25, u8(1))).line(), HasSubstr("LAS 1.1 is not read"));
  EXPECT_THAT(open_error(patched(good, 24, u8(2))).line(), HasSubstr("LAS 2.2 is not read"));
  for (const int compressed : {0x81, 0xC1, 0x41})
    EXPECT_THAT(open_error(patched(good, 104, u8(compressed))).line(),
                HasSubstr("compressed (LAZ); uncompress it first"));
  EXPECT_THAT(open_error(las_bytes(spec_of(2, 0))).line(), HasSubstr("point format 0 has no GPS time"));
  EXPECT_THAT(open_error(las_bytes(spec_of(4, 2))).line(), HasSubstr("point format 2 has no GPS time"));
  EXPECT_THAT(open_error(patched(good, 104, u8(6))).line(), HasSubstr("LAS 1.2 has no point format 6"));
  for (const int format : {11, 99})
    EXPECT_THAT(open_error(patched(newest, 104, u8(format))).line(), HasSubstr("LAS 1.4 has no point format"));
  EXPECT_THAT(open_error(patched(newest, 105, u16(29))).line(), HasSubstr("byte 105: points of 29 bytes"));
  EXPECT_THAT(open_error(patched(good, 94, u16(200))).line(), HasSubstr("byte 94: a header of 200 bytes"));
  EXPECT_THAT(open_error(patched(good, 96, u32(100))).line(), HasSubstr("byte 96: the points begin at byte 100"));
  for (const double scale : {0.0, -0.001, kNaN, kInfinity, 1e9})
    EXPECT_THAT(open_error(patched(good, 139, f64(scale))).line(), HasSubstr("byte 139: the scale of y is"));
  for (const double offset : {kNaN, -kInfinity, 1e300})
    EXPECT_THAT(open_error(patched(good, 171, f64(offset))).line(), HasSubstr("byte 171: the offset of z is"));
  EXPECT_THAT(open_error(las_bytes(spec_of(4, 6, 0))).line(), HasSubstr("it holds no points"));
}

TEST(LasReader, RefusesCountsAndLengthsThatContradictEachOther) {
  const std::string good = las_bytes(spec_of(2, 1)), newest = las_bytes(spec_of(4, 6));
  EXPECT_THAT(open_error(patched(good, 107, u32(0xFFFFFFFF))).line(), HasSubstr("truncated"));
  EXPECT_THAT(open_error(patched(newest, 247, u64(UINT64_MAX))).line(), HasSubstr("truncated"));
  EXPECT_THAT(open_error(patched(newest, 107, u32(2))).line(), HasSubstr("announces 3 points, and 2 in its field"));
  EXPECT_EQ(read_all(patched(patched(newest, 247, u64(0)), 107, u32(3))).rays.size(), 3U) << "an older count alone";
  EXPECT_THAT(open_error(patched(good, 100, u32(1))).line(),
              HasSubstr("at byte 227: record 1 of 1 of variable length reaches into the points"));
  LasSpec spec = spec_of(4, 6);
  spec.records = {las_record("LASF_Projection", 2112, "x")};
  EXPECT_THAT(open_error(patched(las_bytes(spec), 375 + 20, u16(2))).line(), HasSubstr("at byte 375: record 1 of 1"));
  EXPECT_THAT(open_error(patched(las_bytes(spec), 100, u32(0xFFFFFFFF))).line(), HasSubstr("record 2 of 4294967295"));
  spec.extended_count = 1, spec.extended = extended_las_record("LASF_Projection", 2112, "x");
  const std::string extended = las_bytes(spec);
  const std::size_t behind = extended.size() - 61;
  EXPECT_THAT(open_error(patched(extended, 235, u64(behind - 1))).line(),
              HasSubstr("byte 235: the extended records begin"));
  EXPECT_THAT(open_error(patched(extended, 235, u64(UINT64_MAX))).line(),
              HasSubstr("byte 235: the extended records begin"));
  EXPECT_THAT(open_error(patched(extended, behind + 20, u64(UINT64_MAX - 3))).line(),
              HasSubstr("reaches out of the file"));
}

TEST(LasReader, RefusesTrajectoriesOfAnotherDriveOrPlace) {
  LasSpec spec = spec_of(4, 6);
  for (LasTestPoint& point : spec.points) point.time_s -= 86400;
  EXPECT_THAT(open_error(las_bytes(spec)).line(), HasSubstr("none of its points was measured during the trajectory"));
  spec = spec_of(4, 6);
  spec.offset.setZero();
  for (LasTestPoint& point : spec.points) point.position -= kPlace;
  const Error error = open_error(las_bytes(spec));
  EXPECT_EQ(error.code, ErrorCode::bad_input);
  EXPECT_THAT(error.line(), HasSubstr("its points lie 6105 km from the trajectory"));
}

TEST(LasReader, SaysWhatItAssumed) {
  const TemporaryFile file(las_bytes(spec_of(4, 6)), ".las");
  EXPECT_THAT(open(file).value()->notes(),
              ElementsAre("the cloud has adjusted standard GPS time, the trajectory Unix time: 18 leap seconds",
                          "rays begin on the trajectory itself"));
  EXPECT_THAT(open(file, {.lever_arm_m = {0.06, 0, 0.13}, .time_offset_s = -0.002}).value()->notes(),
              Contains("rays begin 0.060 0.000 0.130 m from the trajectory, in its body's frame"));
}

TEST(LasInfo, CountsWhatIsInAFileWithoutATrajectory) {
  LasSpec spec = spec_of(3, 3, 5);
  spec.points[0].return_number = 3;
  spec.points[1].withheld = true;
  spec.points[2].classification = 7;
  const TemporaryFile file(las_bytes(spec) + "trailing", ".las");
  std::uint64_t told = 0;
  const auto info = inspect_las(file.path(), {}, [&told](std::uint64_t points) { told += points; });
  ASSERT_TRUE(info) << info.error().line();
  EXPECT_EQ(told, 5U);
  EXPECT_EQ(info->points, 5U);
  EXPECT_EQ(info->first_returns, 2U);
  EXPECT_EQ(info->later_returns, 1U);
  EXPECT_EQ(info->withheld + info->noise, 2U);
  EXPECT_EQ(info->minor_version, 3);
  EXPECT_EQ(info->point_format, 3);
  EXPECT_TRUE(info->adjusted_gps_time);
  EXPECT_NEAR(*info->start_unix_s, kDrive_s + 1.5, 1e-6);
  EXPECT_LT((info->high - kPlace - Eigen::Vector3d(2, 3, 1)).norm(), 1e-9);
  EXPECT_THAT(info->problems, ElementsAre(HasSubstr("8 bytes follow")));
}

}  // namespace
}  // namespace rayfield::formats
