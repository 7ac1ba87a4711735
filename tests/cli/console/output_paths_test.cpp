#include "cli/console/output_paths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <span>
#include <vector>

#include "tests/cli/program.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;
using test::Folder;
using test::write_file;

TEST(OutputFolder, WhatWasMadeAndStayedEmptyGoesAgain) {
  const Folder folder;
  fs::create_directory(folder.path("mine"));
  {
    const auto made = OutputFolder::make(folder.path("mine/a/b/c"));
    ASSERT_TRUE(made) << made.error().line();
    EXPECT_TRUE(fs::is_directory(folder.path("mine/a/b/c")));
    write_file(folder.path("mine/a/note"), "somebody's");
  }
  EXPECT_FALSE(fs::exists(folder.path("mine/a/b")));
  EXPECT_EQ(test::read_file(folder.path("mine/a/note")), "somebody's");
  { ASSERT_TRUE(OutputFolder::make(folder.path("mine"))); }
  { ASSERT_TRUE(OutputFolder::make(folder.path("new"))); }
  EXPECT_TRUE(fs::is_directory(folder.path("mine")));
  EXPECT_FALSE(fs::exists(folder.path("new")));
}

TEST(OutputFolder, WhatCannotBeMadeLeavesNothingOfItsWay) {
  const Folder folder;
  const std::string too_long(300, 'x');
  EXPECT_FALSE(OutputFolder::make(folder.path("a/b/" + too_long)));
  EXPECT_FALSE(fs::exists(folder.path("a")));
}

std::vector<OutputPath> cloud_and_report(const Folder& folder) {
  return {{"-o", "cannot write ray cloud", folder.path("a.ply")},
          {"--report", "cannot write report", folder.path("a.json")}};
}

TEST(NewOutputs, AreHeldAgainstASecondProgramUntilTheyEnd) {
  const Folder folder;
  const std::vector<OutputPath> outputs = cloud_and_report(folder);
  {
    auto first = NewOutputs::hold(outputs);
    ASSERT_TRUE(first) << first.error().line();
    for (const std::size_t one : {0U, 1U}) {
      const auto second = NewOutputs::hold(std::span(outputs).subspan(one, 1));
      ASSERT_FALSE(second);
      EXPECT_EQ(second.error().code, ErrorCode::usage);
      EXPECT_THAT(second.error().line(), ::testing::HasSubstr("another rayfield is writing it"));
    }
    write_file(outputs[0].path, "a cloud");
    first->keep();
  }
  EXPECT_EQ(test::read_file(outputs[0].path), "a cloud") << "the second has not removed what is the first's";
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(NewOutputs, OfSlamAreRefusedToASecondOne) {
  const Folder folder;
  const std::vector<OutputPath> outputs = cloud_and_report(folder);
  const auto held = NewOutputs::hold(std::span(outputs).subspan(1));
  ASSERT_TRUE(held) << held.error().line();
  const test::Outcome run = test::rayfield({"slam", folder.path("a.bag"), "--rig", folder.path("rig.toml"), "-o",
                                            outputs[0].path, "--report", outputs[1].path, "--overwrite"});
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(run.error_lines(), 1) << run.err;
  EXPECT_THAT(run.err, ::testing::HasSubstr("a.json: another rayfield is writing it"));
}

TEST(NewOutputs, OfACommandThatFailedGoAgainAndThoseThatWereThereStay) {
  const Folder folder;
  const std::vector<OutputPath> outputs = cloud_and_report(folder);
  write_file(outputs[1].path, "an older report");
  fs::create_directory(folder.path(".a.ply.part-lock"));  // of a program that was killed
  {
    const auto held = NewOutputs::hold(outputs);
    ASSERT_TRUE(held) << held.error().line();
    write_file(outputs[0].path, "half a cloud");
  }
  EXPECT_FALSE(fs::exists(outputs[0].path));
  EXPECT_EQ(test::read_file(outputs[1].path), "an older report");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace rayfield::cli
