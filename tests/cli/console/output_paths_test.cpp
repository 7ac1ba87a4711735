#include "cli/console/output_paths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

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

}  // namespace
}  // namespace rayfield::cli
