#include <gtest/gtest.h>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

// Runs a command again and again, killing it at a later and later write, fsync, rename or link (RAYFIELD_FAULT), until
// it gets through; after every kill the store must verify. Returns how often it was killed.
int kill_until_through(const std::vector<std::string>& command, const std::string& store, int stride) {
  for (int kills = 0;; ++kills) {
    const int passage = 1 + kills * stride;
    const Outcome run = rayfield(command, {{"RAYFIELD_FAULT", "*:" + std::to_string(passage) + ":kill"}});
    if (run.exit_code == 0) return kills;
    EXPECT_EQ(run.exit_code, 128 + 9) << run.err;
    if (run.exit_code != 128 + 9) return -1;
    const Outcome verify = rayfield({"verify", store, "-q"});
    EXPECT_EQ(verify.exit_code, 0) << "after a kill at passage " << passage << ": " << verify.err << verify.out;
  }
}

TEST(Crash, AKilledAddAndProcessLeaveAStoreFromWhichTheSameCommandsGiveTheSameBytes) {
  const Folder work;
  const std::string site = small_site(work);
  ASSERT_EQ(rayfield({"simulate", site, "-o", work.path("logs"), "--no-log", "-q"}).exit_code, 0);
  const std::string cloud = work.path("logs/2021-07-01/rays.ply");

  const auto commands = [&](const std::string& store, const std::string& maps) {
    return std::vector<std::vector<std::string>>{{"add", store, cloud, "--date", "2021-07-01", "-q"},
                                                 {"process", store, "-q"},
                                                 {"export", store, "-o", maps, "-q"}};
  };
  std::filesystem::create_directories(work.path("calm"));
  std::filesystem::create_directories(work.path("rough"));
  const std::string calm = work.path("calm/block"), rough = work.path("rough/block");
  ASSERT_EQ(rayfield({"init", calm, "--crs", "EPSG:32632"}).exit_code, 0);
  for (const auto& command : commands(calm, work.path("calm/maps"))) ASSERT_EQ(rayfield(command).exit_code, 0);

  ASSERT_EQ(rayfield({"init", rough, "--crs", "EPSG:32632"}).exit_code, 0);
  const auto disturbed = commands(rough, work.path("rough/maps"));
  EXPECT_GT(kill_until_through(disturbed[0], rough, 3), 5);
  EXPECT_GT(kill_until_through(disturbed[1], rough, 3), 5);
  ASSERT_EQ(rayfield(disturbed[2]).exit_code, 0);
  ASSERT_EQ(rayfield({"gc", rough, "-q"}).exit_code, 0);
  EXPECT_EQ(content_of(rough), content_of(calm));
  EXPECT_EQ(content_of(work.path("rough/maps")), content_of(work.path("calm/maps")));
}

TEST(Crash, AFullDiskIsSaidInOneLineAndLosesNothing) {
  const Folder work;
  const std::string site = small_site(work);
  ASSERT_EQ(rayfield({"simulate", site, "-o", work.path("logs"), "--no-log", "-q"}).exit_code, 0);
  const std::string store = work.path("block");
  ASSERT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
  const std::vector<std::string> add{"add", store, work.path("logs/2021-07-01/rays.ply"), "--date", "2021-07-01", "-q"};
  for (const int passage : {1, 4, 9, 17}) {
    const Outcome run = rayfield(add, {{"RAYFIELD_FAULT", "*:" + std::to_string(passage) + ":enospc"}});
    EXPECT_EQ(run.exit_code, 5) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(rayfield({"verify", store, "-q"}).exit_code, 0);
  }
  EXPECT_EQ(rayfield(add).exit_code, 0);
}

}  // namespace
}  // namespace rayfield::test
