#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/lane_cloud.h"
#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;

// A store with two scans of one day and one of another.
class RemoveRevert : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632"}).exit_code, 0);
    add(50, "2021-05-01", "morning");
    add(60, "2021-05-01", "evening");
    add(70, "2021-04-01", "");  // out of order, which is fine
  }
  void add(std::size_t rays, const std::string& date, const std::string& name) {
    const std::string path = folder_.path(std::to_string(rays) + ".ply");
    write_file(path, lane_cloud(rays));
    std::vector<std::string> arguments{"add", store(), path, "--date", date, "--no-align", "-q"};
    if (!name.empty()) arguments.insert(arguments.end(), {"--name", name});
    ASSERT_EQ(rayfield(arguments).exit_code, 0);
  }
  std::string store() const { return folder_.path("block"); }
  std::vector<std::string> scans() const {
    std::vector<std::string> ids;
    const auto status = nlohmann::json::parse(rayfield({"status", store(), "--json"}).out);
    for (const auto& scan : status["scans"]) ids.push_back(scan["scan_id"]);
    return ids;
  }
  Folder folder_;
};

TEST_F(RemoveRevert, ScansAreInTheOrderOfTheirDatesHoweverTheyWereAdded) {
  EXPECT_THAT(scans(), testing::ElementsAre("2021-04-01", "2021-05-01_evening", "2021-05-01_morning"));
}

TEST_F(RemoveRevert, ARemovedScanComesBackWithRevert) {
  const Outcome removed = rayfield({"remove", store(), "2021-05-01_morning"});
  ASSERT_EQ(removed.exit_code, 0) << removed.err;
  EXPECT_THAT(removed.out, HasSubstr("revert"));
  EXPECT_THAT(scans(), testing::ElementsAre("2021-04-01", "2021-05-01_evening"));
  const auto again = nlohmann::json::parse(rayfield({"remove", store(), "2021-05-01_morning", "--json"}).out);
  EXPECT_EQ(again["already_gone"], true);
  const Outcome reverted = rayfield({"revert", store(), "3", "--json"});
  ASSERT_EQ(reverted.exit_code, 0) << reverted.err;
  EXPECT_EQ(nlohmann::json::parse(reverted.out)["snapshot"], 5);
  EXPECT_EQ(scans().size(), 3U);
  EXPECT_EQ(nlohmann::json::parse(rayfield({"revert", store(), "3", "--json"}).out)["already_there"], true);
  EXPECT_EQ(rayfield({"verify", store(), "--all", "-q"}).exit_code, 0);
}

TEST_F(RemoveRevert, WhatCannotBeDoneIsOneLineAndChangesNothing) {
  const auto before = content_of(store());
  const auto expect_refused = [](const Outcome& run, int code, const std::string& why) {
    EXPECT_EQ(run.exit_code, code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(why));
  };
  expect_refused(rayfield({"remove", store(), "2021-05-01"}), 2, "2021-05-01_evening, 2021-05-01_morning");
  expect_refused(rayfield({"remove", store(), "2021-05-02"}), 2, "no scan of that date");
  expect_refused(rayfield({"remove", store()}), 2, "SCAN");
  expect_refused(rayfield({"revert", store(), "17"}), 2, "1 to 3");
  expect_refused(rayfield({"revert", store(), "first"}), 2, "SNAPSHOT");
  expect_refused(rayfield({"revert", store(), "-1"}), 2, "");
  expect_refused(rayfield({"export", store(), "-o", folder_.path("maps"), "--snapshot", "17"}), 2, "1 to 3");
  EXPECT_EQ(rayfield({"remove", store(), "2021-04-01", "--dry-run"}).exit_code, 0);
  EXPECT_EQ(rayfield({"revert", store(), "1", "--dry-run"}).exit_code, 0);
  EXPECT_EQ(content_of(store()), before);
  EXPECT_EQ(scans().size(), 3U);
}

TEST_F(RemoveRevert, ASnapshotWhoseFilesAreGoneIsRefusedWithTheirNames) {
  ASSERT_EQ(rayfield({"remove", store(), "2021-04-01"}).exit_code, 0);
  std::filesystem::remove_all(std::filesystem::path(store()) / "scans/2021-04-01/rays");
  const Outcome run = rayfield({"revert", store(), "3"});
  EXPECT_EQ(run.exit_code, 4);
  EXPECT_EQ(run.error_lines(), 1);
  EXPECT_THAT(run.err, HasSubstr("scans/2021-04-01/rays/"));
}

// What a farmer types in the field: another day than that of the rays, which are of 2020-09-13 (1.6e9 s).
TEST_F(RemoveRevert, ADateThatIsNotThatOfTheRaysIsWarnedOfInOneLineAndKept) {
  const std::string path = folder_.path("50.ply");
  const Outcome run = rayfield({"add", store(), path, "--date", "2020-09-16", "--no-align"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("warning: measured on 2020-09-13 by its own clock"));
  EXPECT_THAT(rayfield({"status", store()}).out, HasSubstr("not on 2020-09-16: check --date"));
  const Outcome right = rayfield({"add", store(), path, "--date", "2020-09-13", "--name", "right", "--no-align"});
  EXPECT_EQ(right.exit_code, 0) << right.err;
  EXPECT_THAT(right.err, testing::Not(HasSubstr("clock")));
}

}  // namespace
}  // namespace rayfield::test
