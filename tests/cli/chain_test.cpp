#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

namespace fs = std::filesystem;

// Simulates the small site once for all tests of this program.
class Chain : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    logs_ = new Folder;
    const Outcome run = rayfield({"simulate", small_site(*logs_), "-o", logs_->path("logs"), "-q"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  static void TearDownTestSuite() {
    delete logs_;
    logs_ = nullptr;
  }
  static std::string cloud(const std::string& date) { return logs_->path("logs/" + date + "/rays.ply"); }
  static void run_all(const std::string& store, const std::string& maps, const std::string& threads) {
    const auto good = [](const Outcome& run) { ASSERT_EQ(run.exit_code, 0) << run.err; };
    good(rayfield({"init", store, "--crs", "EPSG:32632"}));
    for (const char* date : {"2021-05-01", "2021-07-01"})
      good(rayfield({"add", store, cloud(date), "--date", date, "--threads", threads, "-q"}));
    good(rayfield({"process", store, "--threads", threads, "-q"}));
    good(rayfield({"export", store, "-o", maps, "--threads", threads, "-q"}));
  }
  static Folder* logs_;
};
Folder* Chain::logs_ = nullptr;

TEST_F(Chain, GivesTheSameBytesAtAnyThreadCount) {
  const Folder work;
  std::map<std::string, std::string> store, maps;
  for (const char* threads : {"1", "2", "4"}) {
    const std::string base = std::string("t") + threads;
    fs::create_directories(work.path(base));
    run_all(work.path(base + "/block"), work.path(base + "/maps"), threads);
    if (store.empty()) {
      store = content_of(work.path(base + "/block"));
      maps = content_of(work.path(base + "/maps"));
      EXPECT_GT(store.size(), 20U);
      EXPECT_GT(maps.size(), 10U);
    } else {
      EXPECT_EQ(content_of(work.path(base + "/block")), store) << threads << " threads";
      EXPECT_EQ(content_of(work.path(base + "/maps")), maps) << threads << " threads";
    }
  }
}

TEST_F(Chain, SimulatesTheSameBytesAtAnyThreadCount) {
  const Folder work;
  const std::string site = small_site(work);
  for (const char* threads : {"1", "3"})
    ASSERT_EQ(rayfield({"simulate", site, "-o", work.path(threads), "--threads", threads, "-q"}).exit_code, 0);
  EXPECT_EQ(content_of(work.path("1")), content_of(work.path("3")));
}

TEST_F(Chain, ProcessesOnlyWhatChanged) {
  const Folder work;
  const std::string store = work.path("block");
  ASSERT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
  ASSERT_EQ(rayfield({"add", store, cloud("2021-05-01"), "--date", "2021-05-01", "-q"}).exit_code, 0);
  ASSERT_EQ(rayfield({"process", store, "-q"}).exit_code, 0);
  const auto again = nlohmann::json::parse(rayfield({"process", store, "--json", "-q"}).out);
  EXPECT_EQ(again["scans"][0]["files_made"], 0);
  EXPECT_EQ(again["layout_is_new"], false);

  ASSERT_EQ(rayfield({"add", store, cloud("2021-07-01"), "--date", "2021-07-01", "-q"}).exit_code, 0);
  const auto second = nlohmann::json::parse(rayfield({"process", store, "--json", "-q"}).out);
  EXPECT_EQ(second["scans"][0]["files_made"], 0) << "the first date is as it was";
  EXPECT_GT(second["scans"][1]["files_made"], 0);

  const auto estimator =
      nlohmann::json::parse(rayfield({"process", store, "--estimator", "paper", "--json", "-q"}).out);
  // Results, four rasters, leaf areas and their raster, the estimation, totals, and that the scan is whole; no
  // counters.
  EXPECT_LE(estimator["scans"][0]["files_made"], 10) << "another estimator needs no new count of rays";
}

TEST_F(Chain, KeepsTheIdentityOfPanelsWhenADateIsAdded) {
  const Folder work;
  const std::string store = work.path("block");
  ASSERT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
  ASSERT_EQ(rayfield({"add", store, cloud("2021-07-01"), "--date", "2021-07-01", "-q"}).exit_code, 0);
  const auto first = nlohmann::json::parse(rayfield({"process", store, "--json", "-q"}).out);
  ASSERT_EQ(rayfield({"add", store, cloud("2021-05-01"), "--date", "2021-05-01", "-q"}).exit_code, 0);
  const auto second = nlohmann::json::parse(rayfield({"process", store, "--json", "-q"}).out);
  EXPECT_EQ(second["layout_is_new"], false) << "an earlier date added later does not renumber the block";
  EXPECT_EQ(second["panels"], first["panels"]);
}

TEST_F(Chain, ALayoutWithGivenPanelLengthRules) {
  const Folder work;
  const std::string store = work.path("block");
  ASSERT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
  ASSERT_EQ(rayfield({"add", store, cloud("2021-07-01"), "--date", "2021-07-01", "-q"}).exit_code, 0);
  const auto report = nlohmann::json::parse(rayfield({"process", store, "--panel-length", "7", "--json", "-q"}).out);
  EXPECT_EQ(report["rows"], 2);
  EXPECT_EQ(report["panels"], 4) << "14 m rows hold two panels of 7 m each";
}

}  // namespace
}  // namespace rayfield::test
