#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "rayfield/core/ray_source.h"
#include "rayfield/formats/ply_reader.h"
#include "rayfield/formats/ply_writer.h"
#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using testing::AllOf;
using testing::Each;
using testing::Gt;
using testing::HasSubstr;
using testing::SizeIs;

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

// The same drive somewhere else.
void move_east(const std::string& from, const std::string& to, double east_m) {
  const auto reader = formats::PlyReader::open(from).value();
  formats::PlyWriter writer = formats::PlyWriter::create(to, {*reader->crs()}).value();
  RayBatch rays;
  while (reader->read(rays, 65536).value() > 0) {
    for (std::size_t i = 0; i < rays.size(); ++i) rays.origin[i].x() += east_m, rays.end[i].x() += east_m;
    ASSERT_TRUE(writer.write(rays));
  }
  ASSERT_TRUE(writer.close());
}

std::vector<std::string> csv_column(const std::string& path, const std::string& name) {
  std::istringstream file(read_file(path));
  std::vector<std::string> values;
  std::optional<std::size_t> column;
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
      if (c == ',')
        cells.emplace_back();
      else if (c != '\r')
        cells.back().push_back(c);
    }
    if (!column) column = static_cast<std::size_t>(std::find(cells.begin(), cells.end(), name) - cells.begin());
    values.push_back(*column < cells.size() ? cells[*column] : "no such column");
  }
  values.erase(values.begin());
  return values;
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

TEST_F(Process, AScanWithoutResultsDoesNotKeepTheOthersFromTheirProducts) {
  add(cloud("2021-05-01"), "2021-05-01");
  add(cloud("2021-07-01"), "2021-07-01");
  ASSERT_EQ(rayfield({"process", store(), "-q"}).exit_code, 0);
  const std::string elsewhere = folder_.path("elsewhere.ply");
  move_east(cloud("2021-07-01"), elsewhere, 300);
  add(elsewhere, "2021-08-01");
  const Outcome run = rayfield({"process", store(), "-q"});
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("shows none of the block's rows"));

  const std::string maps = folder_.path("maps"), report = folder_.path("report.html");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"export", store(), "-o", maps},
        std::vector<std::string>{"report", store(), "-o", report}, std::vector<std::string>{"compare", store()},
        std::vector<std::string>{"zones", store(), "-o", maps}}) {
    const Outcome made = rayfield(command);
    EXPECT_EQ(made.exit_code, 0) << command[0] << made.err;
    if (command[0] == "zones") continue;
    EXPECT_THAT(made.err, HasSubstr("2021-08-01 is left out: it has no results")) << command[0];
  }
  EXPECT_TRUE(std::filesystem::exists(maps + "/block_2021-07-01_plan_density.tif"));
  EXPECT_FALSE(std::filesystem::exists(maps + "/block_2021-08-01_plan_density.tif"));
  const Outcome asked = rayfield({"export", store(), "-o", folder_.path("asked"), "--date", "2021-08-01", "-q"});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_THAT(asked.err, HasSubstr("2021-08-01"));
}

TEST_F(Process, WhatWasHardlySeenIsUndefinedInEveryTable) {
  const std::string path = folder_.path("thin.ply");
  thin(cloud("2021-07-01"), path, 100);
  add(path, "2021-07-01");
  ASSERT_EQ(rayfield({"process", store(), "-q"}).exit_code, 0);
  const std::string maps = folder_.path("maps");
  ASSERT_EQ(rayfield({"export", store(), "-o", maps, "-q", "--format", "csv"}).exit_code, 0);
  for (const char* column : {"plant_area_m2", "plant_ci_low_m2", "plant_ci_high_m2", "ci_low_m2"})
    EXPECT_THAT(csv_column(maps + "/block_panels.csv", column), AllOf(SizeIs(Gt(0U)), Each(""))) << column;
  for (const char* column : {"leaf_area_per_m", "plant_area_per_m", "row_gap_share", "canopy_height_m"})
    EXPECT_THAT(csv_column(maps + "/block_row_metres.csv", column), AllOf(SizeIs(Gt(0U)), Each(""))) << column;
}

}  // namespace
}  // namespace rayfield::test
