#include "rayfield/core/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "rayfield/core/sha256.h"

namespace rayfield {
namespace {

namespace fs = std::filesystem;

class File : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "rayfield-file-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  fs::path folder_;
};

TEST_F(File, PipesFoldersAndDevicesAreRefusedWithoutWaiting) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  for (const std::string& name : {path("pipe"), folder_.string(), std::string("/dev/zero")}) {
    const auto file = open_regular_file(name, "cannot read");
    ASSERT_FALSE(file) << name;
    EXPECT_EQ(file.error().code, ErrorCode::bad_input);
  }
}

TEST_F(File, ReadsStopAtTheEnd) {
  write("a", "0123456789");
  const auto file = open_regular_file(path("a"), "cannot read");
  ASSERT_TRUE(file);
  EXPECT_EQ(file->size, 10U);
  std::vector<std::byte> bytes(8);
  EXPECT_EQ(read_at(file->descriptor, 0, bytes, "cannot read", "a").value(), 8U);
  EXPECT_EQ(read_at(file->descriptor, 6, bytes, "cannot read", "a").value(), 4U);
  EXPECT_EQ(read_at(file->descriptor, 10, bytes, "cannot read", "a").value(), 0U);
}

TEST_F(File, DigestsAreThoseOfTheWholeFileAndCanBeCancelled) {
  const std::string text(3'000'000, 'x');
  write("large", text);
  write("empty", "");
  EXPECT_EQ(digest_file(path("large"), "cannot read")->sha256, sha256_hex(text));
  EXPECT_EQ(digest_file(path("large"), "cannot read")->size, text.size());
  EXPECT_EQ(digest_file(path("empty"), "cannot read")->sha256, sha256_hex(std::string_view()));
  EXPECT_EQ(digest_file(path("large"), "cannot read", [] { return true; }).error().code, ErrorCode::interrupted);
}

TEST_F(File, WritesLandWhereTheyShouldAndFailuresSayWhy) {
  const FileDescriptor file(::open(path("out").c_str(), O_RDWR | O_CREAT, 0600));
  const std::string text = "abc";
  ASSERT_TRUE(write_at(file, 2, std::as_bytes(std::span(text)), "cannot write", path("out")));
  EXPECT_EQ(fs::file_size(path("out")), 5U);
  const auto full = FileDescriptor(::open("/dev/full", O_WRONLY));
  const Result<void> failed = write_at(full, 0, std::as_bytes(std::span(text)), "cannot write", "/dev/full");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::resources);
}

TEST_F(File, SyncingSaysWhatTheSystemRefuses) {
  const FileDescriptor file(::open(path("out").c_str(), O_RDWR | O_CREAT, 0600));
  EXPECT_TRUE(sync_file(file, "cannot write", path("out")));
  const Result<void> failed = sync_file(FileDescriptor(), "cannot write", path("out"));
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().where, path("out"));
  EXPECT_TRUE(sync_directory(folder_.string(), "cannot write"));
  EXPECT_FALSE(sync_directory(path("missing"), "cannot write"));
}

TEST_F(File, AWholeFileIsWrittenOrReplaced) {
  const std::string old_text = "what was there", text = "new";
  ASSERT_TRUE(write_whole_file(path("whole"), std::as_bytes(std::span(old_text)), "cannot write"));
  ASSERT_TRUE(write_whole_file(path("whole"), std::as_bytes(std::span(text)), "cannot write"));
  EXPECT_EQ(digest_file(path("whole"), "cannot read")->sha256, sha256_hex(text));
  EXPECT_FALSE(write_whole_file(path("absent/whole"), std::as_bytes(std::span(text)), "cannot write"));
  EXPECT_EQ(write_whole_file("/dev/full", std::as_bytes(std::span(text)), "cannot write").error().code,
            ErrorCode::resources);
}

TEST_F(File, ADescriptorIsClosedOnce) {
  FileDescriptor first(::open(folder_.c_str(), O_RDONLY));
  const int number = first.get();
  FileDescriptor second = std::move(first);
  EXPECT_FALSE(first.valid());
  EXPECT_EQ(second.get(), number);
  EXPECT_EQ(second.close(), 0);
  EXPECT_EQ(second.close(), 0);
  EXPECT_EQ(::fcntl(number, F_GETFD), -1);
}

}  // namespace
}  // namespace rayfield
