#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/lane_cloud.h"
#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A store with two scans, and so with two snapshots.
class Repair : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632"}).exit_code, 0);
    for (const char* date : {"2020-09-13", "2020-09-14"}) {
      write_file(folder_.path("cloud.ply"), lane_cloud(date[9] == '3' ? 50 : 60));
      const Outcome run = rayfield({"add", store(), folder_.path("cloud.ply"), "--date", date, "--no-align", "-q"});
      ASSERT_EQ(run.exit_code, 0) << run.err;
    }
    before_ = content_of(store());
  }
  nlohmann::json json(const std::vector<std::string>& arguments, int exit_code) {
    std::vector<std::string> all = arguments;
    all.insert(all.begin() + 1, store());
    all.emplace_back("--json");
    const Outcome run = rayfield(all);
    EXPECT_EQ(run.exit_code, exit_code) << arguments[0] << ": " << run.err << run.out;
    return nlohmann::json::parse(run.out);
  }
  std::string store() const { return folder_.path("block"); }
  Folder folder_;
  std::map<std::string, std::string> before_;
};

TEST_F(Repair, AStoreWithoutItsSnapshotsIsToldByEveryCommandAndComesBack) {
  fs::remove_all(store() + "/snapshots");
  fs::create_directory(store() + "/snapshots");
  EXPECT_THAT(json({"verify", "--all"}, 4)["damaged"].dump(), HasSubstr("1 to 2"));
  EXPECT_THAT(json({"status"}, 4).dump(), HasSubstr("rayfield repair"));
  EXPECT_THAT(json({"process"}, 4).dump(), HasSubstr("rayfield repair"));
  EXPECT_THAT(json({"gc"}, 4).dump(), HasSubstr("rayfield repair"));
  EXPECT_EQ(content_of(store()), before_) << "gc has deleted nothing";

  const auto dry = json({"repair", "--dry-run"}, 0);
  EXPECT_EQ(dry["rebuilt"].size(), 2U);
  EXPECT_FALSE(fs::exists(store() + "/snapshots/00000003.json"));
  const auto repaired = json({"repair"}, 0);
  EXPECT_EQ(repaired["rebuilt"], nlohmann::json::array({"2020-09-13", "2020-09-14"}));
  EXPECT_EQ(repaired["snapshot"], 3);
  EXPECT_EQ(json({"verify", "--all"}, 0)["ok"], true);
  const auto scans = json({"status"}, 0)["scans"];
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0]["rays"], 50);
  EXPECT_EQ(scans[1]["rays"], 60);
  EXPECT_EQ(json({"gc"}, 0)["files"].size(), 0U);
  EXPECT_EQ(content_of(store()), before_);
  EXPECT_TRUE(json({"repair"}, 0)["found"].empty()) << "there is nothing left to repair";
}

TEST_F(Repair, GcSaysWhatItWouldDeleteAndKeepsRaysInTheTrash) {
  const std::string tile = "/scans/2019-01-01/rays/0_0.0123456789abcdef.h5";
  fs::create_directories(store() + "/scans/2019-01-01/rays");
  write_file(store() + tile, "left by an add that was killed");
  const auto dry = json({"gc", "--dry-run"}, 0);
  ASSERT_EQ(dry["files"].size(), 1U);
  EXPECT_EQ("/" + dry["files"][0]["path"].get<std::string>(), tile);
  EXPECT_TRUE(fs::exists(store() + tile));
  const Outcome run = rayfield({"gc", store()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("scans/2019-01-01/rays: 1 file"));
  EXPECT_FALSE(fs::exists(store() + tile));
  EXPECT_TRUE(fs::exists(store() + "/trash" + tile));
  EXPECT_EQ(json({"gc", "--empty-trash"}, 0)["bytes_freed"], 30);
  EXPECT_EQ(content_of(store()), before_);
}

}  // namespace
}  // namespace rayfield::test
