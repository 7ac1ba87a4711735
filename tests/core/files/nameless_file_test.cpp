#include "rayfield/core/nameless_file.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "rayfield/core/spill_file.h"

namespace {

bool names_stay = false;

}  // namespace

// Takes the place of the system's: a disk that fails when a name is removed leaves it.
extern "C" int unlink(const char* path) noexcept {
  if (names_stay) return errno = EIO, -1;
  static const auto kReal = reinterpret_cast<int (*)(const char*)>(::dlsym(RTLD_NEXT, "unlink"));
  return kReal(path);
}

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

// A temporary file that got a name and could not lose it again was left behind, and what needed it failed.
TEST(NamelessFile, NeedsNoNameToBeRemovedWhereTheFileSystemCanDoWithout) {
  const fs::path folder = fs::temp_directory_path() / ("nameless_file_" + std::to_string(::getpid()));
  fs::create_directory(folder);
  if (!FileDescriptor(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600)).valid())
    GTEST_SKIP() << "the file system of " << folder << " makes no files without a name";
  names_stay = true;
  {
    SpillFile spill(folder);
    const std::vector<std::byte> bytes(100, std::byte{7});
    const auto extent = spill.append(bytes);
    EXPECT_TRUE(extent) << extent.error().line();
  }
  names_stay = false;
  EXPECT_TRUE(fs::is_empty(folder));
  fs::remove_all(folder);
}

TEST(NamelessFile, SaysWhyThereIsNone) {
  EXPECT_FALSE(make_nameless_file("/no such folder").valid());
  EXPECT_EQ(errno, ENOENT);
}

}  // namespace
}  // namespace rayfield
