#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/cli/lane_cloud.h"
#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;

// A store with one scan near Zurich.
class ScanPlace : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632"}).exit_code, 0);
    const Outcome first = add(500000, 5200000, "2020-09-13");
    ASSERT_EQ(first.exit_code, 0) << first.err;
  }
  Outcome add(double east_m, double north_m, const std::string& date) {
    const std::string path = folder_.path("cloud.ply");
    write_file(path, lane_cloud(50, "binary_little_endian", true, east_m, north_m));
    return rayfield({"add", store(), path, "--date", date, "--no-align", "--json"});
  }
  void expect_refused(double east_m, double north_m, const std::string& why) {
    const Outcome run = add(east_m, north_m, "2020-09-14");
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr("cloud.ply"));
    EXPECT_THAT(run.err, HasSubstr(why));
    const auto status = nlohmann::json::parse(rayfield({"status", store(), "--json"}).out);
    EXPECT_EQ(status["scans"].size(), 1U);
  }
  std::string store() const { return folder_.path("block"); }
  Folder folder_;
};

TEST_F(ScanPlace, ACloudInDegreesFeetOrALocalFrameIsRefusedWithTheReason) {
  expect_refused(9.0, 47.0, "in degrees, in feet, in a local frame");
  expect_refused(120, 40, "in degrees, in feet, in a local frame");
  expect_refused(500000 / 0.3048, 5200000 / 0.3048, "in degrees, in feet, in a local frame");
  expect_refused(2600000, 1200000, "CRS");  // the Swiss grid
}

TEST_F(ScanPlace, ACloudOfAnotherPlaceIsRefusedAlsoWhereItIsNotToBeAligned) {
  expect_refused(500000, 5100000, "100 km from the scans of the block");
  EXPECT_EQ(add(500800, 5200000, "2020-09-14").exit_code, 0) << "the other end of a long block";
}

TEST_F(ScanPlace, ACloudFromBesideTheZoneIsTakenAndTold) {
  const std::string other = folder_.path("other");
  ASSERT_EQ(rayfield({"init", other, "--crs", "EPSG:32632"}).exit_code, 0);
  const std::string path = folder_.path("east.ply");
  write_file(path, lane_cloud(50, "binary_little_endian", true, 900000, 5200000));
  const Outcome run = rayfield({"add", other, path, "--date", "2020-09-13", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(nlohmann::json::parse(run.out)["warnings"].dump(), HasSubstr("outside of the area that it is made for"));
  EXPECT_THAT(run.err, HasSubstr("outside of the area that it is made for"));
}

TEST_F(ScanPlace, AScanMayTakeThePlaceOfTheOnlyOneFromElsewhere) {
  const std::string path = folder_.path("right.ply");
  write_file(path, lane_cloud(50, "binary_little_endian", true, 500000, 5100000));
  const Outcome run = rayfield({"add", store(), path, "--date", "2020-09-13", "--no-align", "--overwrite", "-q"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

// The first rays alone do not tell: the second half is of a place 14 km away.
TEST_F(ScanPlace, ACloudHalfOfWhichLiesElsewhereIsTakenAndTold) {
  std::string cloud = lane_cloud(10000);
  const std::size_t body = cloud.find("end_header\n") + 11, ray_bytes = (cloud.size() - body) / 10000;
  for (std::size_t ray = 5000; ray < 10000; ++ray) {
    const double east_m = 514000;
    std::memcpy(cloud.data() + body + ray * ray_bytes, &east_m, sizeof(east_m));
  }
  const std::string path = folder_.path("halves.ply"), other = folder_.path("other");
  write_file(path, cloud);
  ASSERT_EQ(rayfield({"init", other, "--crs", "EPSG:32632"}).exit_code, 0);
  for (const auto& [block, from] :
       {std::pair{store(), "the other scans of the block"}, {other, "where the scan begins"}}) {
    const Outcome run = rayfield({"add", block, path, "--date", "2020-09-14", "--no-align", "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const std::string told = std::string("5 000 of 10 000 rays (50 %) begin up to 14 km from ") + from;
    EXPECT_THAT(nlohmann::json::parse(run.out)["warnings"].dump(), HasSubstr(told));
    EXPECT_THAT(run.err, HasSubstr(told));
    EXPECT_THAT(rayfield({"status", block}).out, HasSubstr(told));
  }
  EXPECT_THAT(add(500800, 5200000, "2020-09-15").err, testing::Not(HasSubstr("km from")));
}

}  // namespace
}  // namespace rayfield::test
