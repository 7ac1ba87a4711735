#include "formats/io/file_io.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <iterator>

#include "tests/formats/temporary_file.h"

namespace rayfield::formats {
namespace {

namespace fs = std::filesystem;
using testing::read_file;
using testing::TemporaryFolder;

std::ptrdiff_t entries_of(const std::string& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

TEST(OutputFile, AppearsWholeOrNotAtAll) {
  const TemporaryFolder folder;
  const std::string path = folder / "cloud.ply";
  {
    auto file = OutputFile::create(path, "cannot write");
    ASSERT_TRUE(file) << file.error().line();
    ASSERT_TRUE(file->write("half"));
    EXPECT_FALSE(fs::exists(path));
  }
  EXPECT_EQ(entries_of(folder.path()), 0) << "dropped";
  auto file = OutputFile::create(path, "cannot write");
  ASSERT_TRUE(file->write("whole"));
  ASSERT_TRUE(file->overwrite(0, std::as_bytes(std::span("W", 1))));
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(read_file(path), "Whole");
  EXPECT_EQ(entries_of(folder.path()), 1);
  EXPECT_EQ(OutputFile::create(folder / "none/a", "w").error().code, ErrorCode::usage);
}

TEST(OutputFile, WhatAKilledProgramLeftIsRemovedByTheNextOneThatWritesTheFile) {
  const TemporaryFolder folder;
  const std::string path = folder / "cloud.ply";
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto file = OutputFile::create(path, "cannot write");
    if (file && file->write("torn")) ::raise(SIGKILL);
    ::_exit(1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_EQ(entries_of(folder.path()), 1) << "what it left";
  auto file = OutputFile::create(path, "cannot write");
  ASSERT_TRUE(file->write("whole"));
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(read_file(path), "whole");
  EXPECT_EQ(entries_of(folder.path()), 1) << "the file alone";
}

}  // namespace
}  // namespace rayfield::formats
