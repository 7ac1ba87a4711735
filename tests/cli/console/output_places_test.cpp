#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;
using Command = std::vector<std::string>;

class OutputPlaces : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    work_ = new Folder;
    ASSERT_EQ(rayfield({"simulate", small_site(*work_), "-o", work_->path("logs"), "--no-log", "-q"}).exit_code, 0);
    ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632", "-q"}).exit_code, 0);
    for (const std::string date : {"2021-05-01", "2021-07-01"})
      ASSERT_EQ(
          rayfield({"add", store(), work_->path("logs/" + date + "/rays.ply"), "--date", date, "--no-align", "-q"})
              .exit_code,
          0);
    ASSERT_EQ(rayfield({"process", store(), "-q"}).exit_code, 0);
  }
  static void TearDownTestSuite() { delete work_; }
  static std::string store() { return work_->path("block"); }
  /// Every command that makes a folder or a file, into `place`.
  static std::vector<Command> all_into(const std::string& place) {
    return {{"export", store(), "-o", place, "-q"},
            {"compare", store(), "-o", place, "-q"},
            {"zones", store(), "-o", place, "-q"},
            {"report", store(), "-o", place, "-q"},
            {"registry", "export", store(), "-o", place, "-q"},
            {"simulate", small_site(*work_), "-o", place, "-q"},
            {"init", place, "--crs", "EPSG:32632", "-q"},
            {"demo", place, "-q"}};
  }
  static void expect_line(const Command& command, int code) {
    const Outcome run = rayfield(command);
    EXPECT_EQ(run.exit_code, code) << command[0] << ": " << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << command[0] << ": " << run.err;
  }
  static Folder* work_;
};
Folder* OutputPlaces::work_ = nullptr;

TEST_F(OutputPlaces, WhereNothingCanBeMadeEveryCommandEndsWithFive) {
  for (Command command : all_into("/proc/x")) {
    if (command[0] == "registry")
      std::replace(command.begin(), command.end(), std::string("/proc/x"), std::string("/proc/x.csv"));
    expect_line(command, 5);
  }
}

TEST_F(OutputPlaces, NoNameIsWrongUsage) {
  for (const Command& command : all_into("")) expect_line(command, 2);
}

TEST_F(OutputPlaces, APipeIsNotReplacedByAFile) {
  const std::string pipe = work_->path("pipe.html");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const Outcome run = rayfield({"report", store(), "-o", pipe, "--overwrite", "-q"});
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_THAT(run.err, HasSubstr("not a regular file"));
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

// Here it is a store with a map missing.
TEST_F(OutputPlaces, ARefusedCommandLeavesNoFolderBehind) {
  const std::string damaged = work_->path("damaged"), place = work_->path("new/maps");
  std::filesystem::copy(store(), damaged, std::filesystem::copy_options::recursive);
  for (const auto& entry : std::filesystem::directory_iterator(damaged + "/scans/2021-07-01/raster"))
    std::filesystem::remove(entry.path());
  for (const Command& command :
       {Command{"export", damaged, "-o", place, "-q"}, Command{"zones", damaged, "-o", place, "-q"}}) {
    expect_line(command, 4);
    EXPECT_FALSE(std::filesystem::exists(work_->path("new"))) << command[0];
    std::filesystem::remove_all(work_->path("new"));
  }
}

}  // namespace
}  // namespace rayfield::test
