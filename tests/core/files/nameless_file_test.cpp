#include "rayfield/core/nameless_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

namespace rayfield {
namespace {

namespace fs = std::filesystem;

TEST(NamelessFile, CanBeWrittenAndReadAndLeavesNothingInItsFolder) {
  const fs::path folder = fs::temp_directory_path() / ("nameless_file_" + std::to_string(::getpid()));
  fs::create_directory(folder);
  {
    const FileDescriptor file = make_nameless_file(folder);
    ASSERT_TRUE(file.valid());
    EXPECT_TRUE(fs::is_empty(folder));
    EXPECT_EQ(::pwrite(file.get(), "ab", 2, 0), 2);
    char text[2] = {};
    EXPECT_EQ(::pread(file.get(), text, 2, 0), 2);
    EXPECT_EQ(text[1], 'b');
    struct stat status {};
    ASSERT_EQ(::fstat(file.get(), &status), 0);
    EXPECT_EQ(status.st_nlink, 0U);
  }
  EXPECT_TRUE(fs::is_empty(folder));
  fs::remove(folder);
}

TEST(NamelessFile, SaysWhyThereIsNone) {
  EXPECT_FALSE(make_nameless_file("/no such folder").valid());
  EXPECT_EQ(errno, ENOENT);
}

}  // namespace
}  // namespace rayfield
