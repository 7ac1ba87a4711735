#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "rayfield/core/ray_source.h"
#include "rayfield/formats/ply_reader.h"
#include "rayfield/formats/ply_writer.h"
#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;

// Keeps one ray in `step`.
void thin(const std::string& from, const std::string& to, std::size_t step) {
  const auto reader = formats::PlyReader::open(from).value();
  formats::PlyWriter writer = formats::PlyWriter::create(to, {*reader->crs()}).value();
  RayBatch all, few;
  std::size_t ray = 0;
  while (reader->read(all, 65536).value() > 0) {
    few.clear();
    for (std::size_t i = 0; i < all.size(); ++i)
      if (ray++ % step == 0) few.push(all.origin[i], all.end[i], all.time_s[i], all.intensity[i], all.hit[i] != 0);
    ASSERT_TRUE(writer.write(few));
  }
  ASSERT_TRUE(writer.close());
}

class Process : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    work_ = new Folder;
    ASSERT_EQ(rayfield({"simulate", small_site(*work_), "-o", work_->path("logs"), "--no-log", "-q"}).exit_code, 0);
  }
  static void TearDownTestSuite() { delete work_; }
  void SetUp() override { ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632"}).exit_code, 0); }
  std::string store() const { return folder_.path("block"); }
  static std::string cloud(const std::string& date) { return work_->path("logs/" + date + "/rays.ply"); }
  void add(const std::string& path, const std::string& date) {
    const Outcome run = rayfield({"add", store(), path, "--date", date, "--no-align", "-q"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  static Folder* work_;
  Folder folder_;
};
Folder* Process::work_ = nullptr;

TEST_F(Process, WhatWasSeenByTooFewRaysIsUndefinedAndNotZero) {
  const std::string path = folder_.path("thin.ply");
  thin(cloud("2021-07-01"), path, 12);
  add(path, "2021-07-01");
  const Outcome run = rayfield({"process", store()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("plant area undefined"));
  EXPECT_THAT(run.out, testing::Not(HasSubstr("0.0 m²")));
  const auto scan = nlohmann::json::parse(rayfield({"process", store(), "--json"}).out)["scans"][0];
  EXPECT_TRUE(scan["plant_area_m2"].is_null());
  EXPECT_EQ(scan["panels_with_value"], 0);
  EXPECT_GT(scan["panels"], 0);
  EXPECT_GT(scan["observed_fraction"], 0.0);
  EXPECT_LT(scan["observed_fraction"], 0.5);
}

TEST_F(Process, AScanOfWhichNothingCanBeMadeDoesNotKeepTheOthersFromTheirs) {
  add(cloud("2021-05-01"), "2021-05-01");
  add(cloud("2021-07-01"), "2021-07-01");
  const auto alone = nlohmann::json::parse(rayfield({"process", store(), "--json"}).out);
  add(cloud("2021-05-01"), "2021-06-01");
  const std::filesystem::path rays = store() + "/scans/2021-06-01/rays";
  std::filesystem::resize_file(std::filesystem::directory_iterator(rays)->path(), 1000);

  const Outcome run = rayfield({"process", store(), "--overwrite", "--json"});
  EXPECT_EQ(run.exit_code, 4) << run.err;
  EXPECT_THAT(run.err, HasSubstr("2021-06-01"));
  const auto report = nlohmann::json::parse(run.out);
  ASSERT_EQ(report["failed"].size(), 1U) << run.out;
  EXPECT_EQ(report["failed"][0]["scan_id"], "2021-06-01");
  EXPECT_EQ(report["failed"][0]["code"], 4);
  ASSERT_EQ(report["scans"].size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(report["scans"][i]["scan_id"], alone["scans"][i]["scan_id"]);
    EXPECT_EQ(report["scans"][i]["plant_area_m2"], alone["scans"][i]["plant_area_m2"]);
  }
  ASSERT_EQ(rayfield({"remove", store(), "2021-06-01", "-q"}).exit_code, 0);
  EXPECT_EQ(rayfield({"process", store(), "-q"}).exit_code, 0);
}

}  // namespace
}  // namespace rayfield::test
