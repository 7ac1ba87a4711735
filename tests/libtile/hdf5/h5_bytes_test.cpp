#include "libtile/hdf5/h5_bytes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

constexpr std::uint64_t kMost = ~std::uint64_t{0};

std::vector<std::byte> numbered(std::size_t size) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 31 + i / 256);
  return bytes;
}

struct OnDisk {
  explicit OnDisk(const std::vector<std::byte>& bytes) {
    write_text(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    file = std::move(*open_regular_file(path.string(), "cannot read"));
  }
  ScratchFolder folder;
  fs::path path = folder.path() / "file";
  InputDescriptor file;
};

void expect_bounded(H5Bytes& bytes) {
  EXPECT_TRUE(bytes.view(0, bytes.size()));
  EXPECT_TRUE(bytes.view(bytes.size(), 0));
  EXPECT_FALSE(bytes.view(bytes.size(), 1));
  EXPECT_FALSE(bytes.view(bytes.size() + 1, 0));
  EXPECT_FALSE(bytes.view(1, bytes.size()));
  EXPECT_FALSE(bytes.view(1, kMost));
  EXPECT_FALSE(bytes.view(kMost, 1));
  EXPECT_FALSE(bytes.view(kMost, kMost));
  const auto error = bytes.view(kMost - 1, 2).error();
  EXPECT_EQ(error.code, ErrorCode::damaged);
  EXPECT_THAT(error.line(), ::testing::HasSubstr("the file at byte 18446744073709551614"));
}

TEST(H5Bytes, NothingOutsideOfTheFileIsRead) {
  const std::vector<std::byte> content = numbered(30000);
  const OnDisk disk(content);
  H5Bytes from_memory(content, "the file"), from_disk(disk.file.descriptor, disk.file.size, "the file");
  expect_bounded(from_memory);
  expect_bounded(from_disk);
}

TEST(H5Bytes, AnyOrderOfReadingGivesTheBytesOfTheFile) {
  const std::vector<std::byte> content = numbered(50000);
  const OnDisk disk(content);
  H5Bytes bytes(disk.file.descriptor, disk.file.size, "the file");
  std::mt19937 random(3);
  for (int i = 0; i < 5000; ++i) {
    const std::size_t offset = random() % content.size();
    const std::size_t count = random() % std::min<std::size_t>(content.size() - offset + 1, i % 10 == 0 ? 20000 : 300);
    const auto view = bytes.view(offset, count);
    ASSERT_TRUE(view);
    ASSERT_TRUE(std::ranges::equal(*view, std::span(content).subspan(offset, count))) << offset << ' ' << count;
  }
}

TEST(H5Bytes, AFileThatWasCutWhileItIsReadIsDamaged) {
  const OnDisk disk(numbered(50000));
  H5Bytes bytes(disk.file.descriptor, disk.file.size, "the file");
  fs::resize_file(disk.path, 100);
  for (const std::uint64_t offset : {0, 20000, 0}) {
    const auto view = bytes.view(offset, 200);
    ASSERT_FALSE(view);
    EXPECT_EQ(view.error().code, ErrorCode::damaged);
  }
}

}  // namespace
}  // namespace rayfield::tile::testing
