#include "rayfield/core/spill_file.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <thread>
#include <vector>

namespace rayfield {
namespace {

std::vector<std::byte> bytes_of(int seed, std::size_t count) {
  std::vector<std::byte> out(count);
  for (std::size_t k = 0; k < count; ++k)
    out[k] = static_cast<std::byte>((k * 31 + static_cast<std::size_t>(seed)) & 255);
  return out;
}

TEST(SpillFile, GivesBackWhatSeveralThreadsPutAside) {
  SpillFile file(std::filesystem::temp_directory_path());
  std::array<std::vector<SpillFile::Extent>, 3> extents;
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t)
    threads.emplace_back([&, t] {
      for (int k = 0; k < 50; ++k) {
        const auto extent = file.append(bytes_of(t + k, 1000 + 17u * static_cast<unsigned>(k)));
        ASSERT_TRUE(extent);
        extents[static_cast<std::size_t>(t)].push_back(*extent);
      }
    });
  for (std::thread& t : threads) t.join();
  for (int t = 0; t < 3; ++t)
    for (int k = 0; k < 50; ++k) {
      const SpillFile::Extent& extent = extents[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)];
      std::vector<std::byte> bytes(extent.size);
      ASSERT_TRUE(k % 2 == 0 ? file.read(extent, bytes) : file.take(extent, bytes));
      EXPECT_EQ(bytes, bytes_of(t + k, extent.size));
    }
}

TEST(SpillFile, AnExtentThatIsOverwrittenHoldsTheNewBytesAndItsNeighboursTheirs) {
  SpillFile file(std::filesystem::temp_directory_path());
  const auto first = file.append(bytes_of(1, 5000)), second = file.append(bytes_of(2, 5000));
  ASSERT_TRUE(first && second);
  ASSERT_TRUE(file.overwrite(*first, bytes_of(3, 5000)));
  EXPECT_EQ(file.bytes_written(), 10000u);
  std::vector<std::byte> bytes(5000);
  ASSERT_TRUE(file.read(*first, bytes));
  EXPECT_EQ(bytes, bytes_of(3, 5000));
  ASSERT_TRUE(file.read(*second, bytes));
  EXPECT_EQ(bytes, bytes_of(2, 5000));
}

TEST(SpillFile, LeavesNoNameBehindAndStartsAnewWhenCleared) {
  const auto folder = std::filesystem::temp_directory_path() / "rayfield-spill-test";
  std::filesystem::create_directory(folder);
  {
    SpillFile file(folder);
    ASSERT_TRUE(file.append(bytes_of(1, 100)));
    EXPECT_TRUE(std::filesystem::is_empty(folder));
    ASSERT_TRUE(file.clear());
    EXPECT_EQ(file.bytes_written(), 0u);
    const auto extent = file.append(bytes_of(2, 50));
    ASSERT_TRUE(extent);
    EXPECT_EQ(extent->offset, 0u);
    std::vector<std::byte> bytes(50);
    ASSERT_TRUE(file.read(*extent, bytes));
    EXPECT_EQ(bytes, bytes_of(2, 50));
    std::vector<std::byte> beyond(60);
    EXPECT_FALSE(file.read({0, 60}, beyond));
  }
  std::filesystem::remove(folder);
}

TEST(SpillFile, SaysWhereItCannotBeMade) {
  SpillFile file("/no/such/folder");
  const auto result = file.append(bytes_of(1, 10));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::resources);
  EXPECT_NE(result.error().line().find("/no/such/folder"), std::string::npos) << result.error().line();
}

}  // namespace
}  // namespace rayfield
