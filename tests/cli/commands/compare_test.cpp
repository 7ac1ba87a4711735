#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kAgain = "[[date]]\ndate = \"2021-07-02\"\nleaf_fraction = 1.0\nseed = 5\n";

// The small site with two dates that differ and a repeat of the second, processed once for all tests of this program.
class Compare : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    work_ = new Folder;
    const auto good = [](const std::vector<std::string>& arguments) {
      const Outcome run = rayfield(arguments);
      ASSERT_EQ(run.exit_code, 0) << run.err;
    };
    const std::string logs = work_->path("logs");
    good({"simulate", small_site(*work_, kEarlyDate + kLateDate + kAgain), "-o", logs, "--no-log", "-q"});
    good({"init", store(), "--crs", "EPSG:32632"});
    for (const char* date : {"2021-05-01", "2021-07-01", "2021-07-02"})
      good({"add", store(), logs + "/" + date + "/rays.ply", "--date", date, "-q"});
    good({"process", store(), "-q"});
  }
  static void TearDownTestSuite() {
    delete work_;
    work_ = nullptr;
  }
  static std::string store() { return work_->path("block"); }
  static void expect_refused(const std::vector<std::string>& arguments, int exit_code, const std::string& why) {
    const Outcome run = rayfield(arguments);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(why));
  }
  static Folder* work_;
};
Folder* Compare::work_ = nullptr;

TEST_F(Compare, SaysInOneDocumentThatEveryPanelGrew) {
  const Outcome run = rayfield({"compare", store(), "2021-05-01", "2021-07-01", "--json", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["a"]["date"], "2021-05-01");
  EXPECT_EQ(json["b"]["date"], "2021-07-01");
  const std::size_t panels = json["panels"].size();
  EXPECT_GT(panels, 1U);
  EXPECT_EQ(json["panels_compared"], panels);
  EXPECT_EQ(json["gains"], panels) << "60 % of the leaves grew between the dates";
  EXPECT_EQ(json["leaf_area"]["significance"], "gain");
  double sum = 0;
  for (const auto& panel : json["panels"]) {
    const double change = panel["leaf_change_m2"];
    EXPECT_NEAR(change, panel["leaf_area_b_m2"].get<double>() - panel["leaf_area_a_m2"].get<double>(), 1e-9);
    EXPECT_LT(panel["ci_low_m2"], change);
    EXPECT_GT(panel["ci_low_m2"], 0);
    sum += change;
  }
  EXPECT_NEAR(json["leaf_area"]["change_m2"], sum, 1e-9);
  EXPECT_TRUE(json["files"].empty()) << "nothing is written without -o";
  EXPECT_GT(json["half_metres_leaf_area_per_m"]["count"], 20);
}

TEST_F(Compare, FindsTwoDrivesThroughTheSameLeavesEqual) {
  const auto json =
      nlohmann::json::parse(rayfield({"compare", store(), "2021-07-01", "2021-07-02", "--json", "-q"}).out);
  // Repeated drives of all sites differ by 0.9 to 2 % (docs/accuracy.md).
  EXPECT_LT(json["panels_leaf_area_per_m"]["rrmse"], 0.035);
  EXPECT_LE(json["gains"].get<int>() + json["losses"].get<int>(), 1);
}

TEST_F(Compare, WritesChartsMapsAndLayersThatRepeatByteForByte) {
  const Folder out;
  for (const char* folder : {"one", "two"}) {
    const Outcome run = rayfield({"compare", store(), "2021-05-01", "2021-07-01", "-o", out.path(folder), "-q"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  const auto one = content_of(out.path("one"));
  EXPECT_EQ(one, content_of(out.path("two")));
  const std::string stem = "block_2021-05-01_2021-07-01_";
  for (const char* ending : {"scatter.png", "scatter.svg", "plan_density_change.tif", "plan_density_change.qml",
                             "plan_density_change.png", "canopy_height_change.tif", "change.gpkg", "change.csv"})
    EXPECT_EQ(one.count(stem + ending), 1U) << ending;
}

TEST_F(Compare, WithoutDatesDrawsTheSeasonAndAStackOfEveryRow) {
  const Folder out;
  const Outcome run = rayfield({"compare", store(), "-o", out.path("season"), "--json", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["season"].size(), 9U) << "block and two rows on three dates";
  const auto files = content_of(out.path("season"));
  for (const char* name :
       {"block_season.csv", "block_season.png", "block_season.svg", "block_row_1_stack.png", "block_row_2_stack.png"})
    EXPECT_EQ(files.count(name), 1U) << name;
  EXPECT_LT(json["season"][0]["leaf_area_per_m"], json["season"][3]["leaf_area_per_m"]);
}

TEST_F(Compare, DatesThatCannotBeComparedAreRefusedWithTheReason) {
  expect_refused({"compare", store(), "2021-05-01", "2021-06-01"}, 2, "2021-06-01");
  expect_refused({"compare", store(), "2021-05-01", "2021-05-01"}, 2, "same scan twice");
  expect_refused({"compare", store(), "2021-05-01"}, 2, "two dates");
  expect_refused({"compare", store(), "2021-05-01", "2021-07-01", "2021-07-02"}, 2, "2 required");
  expect_refused({"compare", work_->path("none"), "2021-05-01", "2021-07-01"}, 3, "none");
  expect_refused({"compare", store(), "2021-05-01", "2021-07-01", "--set", "error_correlation=2"}, 2,
                 "error_correlation");

  const Folder other;
  const std::string fresh = other.path("fresh"), logs = work_->path("logs");
  ASSERT_EQ(rayfield({"init", fresh, "--crs", "EPSG:32632"}).exit_code, 0);
  for (const char* date : {"2021-05-01", "2021-07-01"})
    ASSERT_EQ(rayfield({"add", fresh, logs + "/" + date + "/rays.ply", "--date", date, "-q"}).exit_code, 0);
  expect_refused({"compare", fresh, "2021-05-01", "2021-07-01"}, 2, "not been processed");
  expect_refused({"compare", fresh}, 2, "not been processed");
  ASSERT_EQ(rayfield({"process", fresh, "--date", "2021-05-01", "-q"}).exit_code, 0);
  expect_refused({"compare", fresh, "2021-05-01", "2021-07-01"}, 2, "2021-07-01");

  ASSERT_EQ(rayfield({"add", fresh, logs + "/2021-07-02/rays.ply", "--date", "2021-07-01", "--name", "again", "-q"})
                .exit_code,
            0);
  expect_refused({"compare", fresh, "2021-05-01", "2021-07-01_again", "-q"}, 2, "2021-07-01_again");
}

TEST_F(Compare, ADryRunWritesNothing) {
  const Folder out;
  const Outcome run =
      rayfield({"compare", store(), "2021-05-01", "2021-07-01", "-o", out.path("maps"), "--dry-run", "-q"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_FALSE(fs::exists(out.path("maps")));
}

}  // namespace
}  // namespace rayfield::test
