#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// The small site on two dates, processed once for all tests of this program; its block has a name that is HTML.
class Report : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    work_ = new Folder;
    const auto good = [](const std::vector<std::string>& arguments) {
      const Outcome run = rayfield(arguments);
      ASSERT_EQ(run.exit_code, 0) << run.err;
    };
    const std::string logs = work_->path("logs");
    good({"simulate", small_site(*work_), "-o", logs, "--no-log", "-q"});
    good({"init", store(), "--crs", "EPSG:32632"});
    for (const char* date : {"2021-05-01", "2021-07-01"})
      good({"add", store(), logs + "/" + date + "/rays.ply", "--date", date, "-q"});
    good({"process", store(), "-q"});
    good({"registry", "rename", store(), "--block", "<img src=x onerror=alert(1)>"});
  }
  static void TearDownTestSuite() {
    delete work_;
    work_ = nullptr;
  }
  static std::string store() { return work_->path("block"); }
  static void expect_refused(const Outcome& run, int exit_code, const std::string& why) {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(why));
  }
  Folder out_;
  static Folder* work_;
};
Folder* Report::work_ = nullptr;

TEST_F(Report, IsOneFileThatSaysWhatItHolds) {
  const std::string path = out_.path("report.html");
  const Outcome run = rayfield({"report", store(), "-o", path, "--json", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["bytes"], fs::file_size(path));
  EXPECT_EQ(json["dates"].size(), 2U);
  EXPECT_GT(json["panels"], 4);
  const std::string html = read_file(path);
  EXPECT_THAT(html, StartsWith("<!doctype html>\n<!-- rayfield report -->"));
  EXPECT_THAT(html, HasSubstr("1 Jul 2021"));
  EXPECT_THAT(html, HasSubstr("clear gain")) << "60 % of the leaves grew between the dates";
  EXPECT_THAT(html, Not(HasSubstr("<img")));
  EXPECT_THAT(html, HasSubstr("Block &lt;img src=x onerror=alert(1)&gt;"));
  EXPECT_EQ(std::distance(fs::directory_iterator(out_.path()), fs::directory_iterator()), 1) << "and nothing beside";
}

TEST_F(Report, RepeatsByteForByteAndReplacesAnOlderReport) {
  const std::string path = out_.path("report.html");
  ASSERT_EQ(rayfield({"report", store(), "-o", path, "-q"}).exit_code, 0);
  const std::string first = read_file(path);
  ASSERT_EQ(rayfield({"report", store(), "-o", path, "-q", "--date", "2021-05-01"}).exit_code, 0);
  EXPECT_NE(read_file(path), first) << "one date alone";
  ASSERT_EQ(rayfield({"report", store(), "-o", path, "-q"}).exit_code, 0);
  EXPECT_EQ(read_file(path), first);
}

TEST_F(Report, BadTargetsLeaveWhatIsThereAndEndWithFive) {
  fs::create_directories(out_.path("report.html/mine"));
  expect_refused(rayfield({"report", store(), "-o", out_.path("report.html"), "-q"}), 5, "folder is in the way");
  EXPECT_TRUE(fs::exists(out_.path("report.html/mine")));
  expect_refused(rayfield({"report", store(), "-o", "/proc/report.html", "-q"}), 5, "/proc/report.html");

  const std::string path = out_.path("old.html");
  ASSERT_EQ(rayfield({"report", store(), "-o", path, "-q", "--date", "2021-05-01"}).exit_code, 0);
  const std::string old = read_file(path);
  expect_refused(rayfield_with_file_limit({"report", store(), "-o", path, "-q"}, 20'000), 5, "old.html");
  EXPECT_EQ(read_file(path), old);
  EXPECT_EQ(std::distance(fs::directory_iterator(out_.path()), fs::directory_iterator()), 2)
      << "nothing is left beside";
}

TEST_F(Report, AFolderThatCannotBeWrittenToEndsWithFive) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::create_directory(out_.path("locked"));
  fs::permissions(out_.path("locked"), fs::perms::owner_read | fs::perms::owner_exec);
  expect_refused(rayfield({"report", store(), "-o", out_.path("locked/report.html"), "-q"}), 5, "Permission denied");
}

TEST_F(Report, AnotherFileIsNotReplacedUnlessAskedFor) {
  const std::string path = out_.path("thesis.html");
  write_file(path, "<!doctype html>\n<title>mine</title>");
  expect_refused(rayfield({"report", store(), "-o", path, "-q"}), 2, "no report");
  EXPECT_THAT(read_file(path), HasSubstr("mine"));
  EXPECT_EQ(rayfield({"report", store(), "-o", path, "-q", "--overwrite"}).exit_code, 0);
  EXPECT_THAT(read_file(path), Not(HasSubstr("mine")));
}

TEST_F(Report, WrongUsageEndsWithTwo) {
  const std::string path = out_.path("report.html");
  expect_refused(rayfield({"report", store()}), 2, "--output");
  expect_refused(rayfield({"report", store(), "-o", out_.path("none/report.html")}), 2, "no folder");
  expect_refused(rayfield({"report", store(), "-o", path, "--date", "2020-01-01"}), 2, "2020-01-01");
  expect_refused(rayfield({"report", store(), "-o", path, "--set", "gaps.share_of_median=7"}), 2, "share_of_median");
  expect_refused(rayfield({"report", work_->path("none"), "-o", path}), 3, "none");
  ASSERT_EQ(rayfield({"init", out_.path("fresh"), "--crs", "EPSG:32632"}).exit_code, 0);
  expect_refused(rayfield({"report", out_.path("fresh"), "-o", path}), 2, "not been processed");
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(Report, ADryRunWritesNothing) {
  const Outcome run = rayfield({"report", store(), "-o", out_.path("report.html"), "--dry-run", "--json", "-q"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["dry_run"], true);
  EXPECT_FALSE(fs::exists(out_.path("report.html")));
}

}  // namespace
}  // namespace rayfield::test
