#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Command = std::vector<std::string>;

// An empty store; what is asked of it is refused for the place of the output before anything else is looked at.
class OutputsInAStore : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632", "-q"}).exit_code, 0); }
  std::string store() const { return folder_.path("block"); }
  std::set<std::string> names() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(store())) names.insert(entry.path().string());
    return names;
  }
  /// Every command that writes, to a folder or a file at `place`.
  std::vector<Command> all_into(const std::string& place) const {
    return {{"export", store(), "-o", place},
            {"export", store(), "-o", place, "--dry-run"},
            {"compare", store(), "-o", place},
            {"zones", store(), "-o", place},
            {"report", store(), "-o", place + "/a.html"},
            {"registry", "export", store(), "-o", place + "/a.csv"},
            {"slam", "a.bag", "--rig", "rig.toml", "-o", place + "/a.ply"},
            {"slam", "a.bag", "--rig", "rig.toml", "-o", folder_.path("a.ply"), "--report", place + "/a.json"},
            {"update", store(), "a.ply", "--date", "2021-05-01", "-o", place},
            {"update", store(), "a.ply", "--date", "2021-05-01", "-o", place, "--dry-run"},
            {"simulate", small_site(folder_), "-o", place},
            {"experiment", "turbid", "--trials", "2", "-o", place},
            {"demo", place},
            {"help", "--man", place}};
  }
  void expect_refused(const Command& command) const {
    const Outcome run = rayfield(command);
    EXPECT_EQ(run.exit_code, 2) << command[0] << ": " << run.err;
    EXPECT_EQ(run.error_lines(), 1) << command[0] << ": " << run.err;
    EXPECT_THAT(run.err, HasSubstr("it lies in the store " + fs::canonical(store()).string())) << command[0];
  }
  Folder folder_;
};

TEST_F(OutputsInAStore, AreRefusedByEveryCommand) {
  const auto before = names();
  for (const Command& command : all_into(store() + "/maps")) expect_refused(command);
  for (const Command& command : all_into(store() + "/scans")) expect_refused(command);
  expect_refused({"export", store(), "-o", store()});
  expect_refused({"init", store() + "/other", "--crs", "EPSG:32632"});
  expect_refused({"update", store() + "/other", "a.ply", "--date", "2021-05-01", "--crs", "EPSG:32632"});
  EXPECT_EQ(names(), before);
}

TEST_F(OutputsInAStore, AreKnownHoweverThePlaceIsWritten) {
  fs::create_directory_symlink(store() + "/scans", folder_.path("link"));
  for (const std::string& place : {folder_.path("link/maps"), folder_.path("nowhere/../block/maps"),
                                   store() + "/scans/../maps", folder_.path("link")})
    expect_refused({"export", store(), "-o", place});
}

TEST_F(OutputsInAStore, BesideAStoreIsNotInIt) {
  const Outcome run = rayfield({"export", store(), "-o", store() + "/../block_maps"});
  EXPECT_THAT(run.err, HasSubstr("not been processed"));
  EXPECT_EQ(rayfield({"help", "--man", folder_.path("block_man")}).exit_code, 0);
}

}  // namespace
}  // namespace rayfield::test
