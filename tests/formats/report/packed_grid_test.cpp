#include "formats/report/packed_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <limits>
#include <string>
#include <vector>

namespace rayfield::formats {
namespace {

using ::testing::ElementsAre;

constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();

// What the page's script does: base64, then zlib.
std::vector<int> unpacked(const std::string& text, std::size_t count) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<Bytef> bytes;
  unsigned bits = 0, value = 0;
  for (const char c : text) {
    if (c == '=') break;
    value = value << 6U | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits >= 8) bytes.push_back(static_cast<Bytef>(value >> (bits -= 8)));
  }
  std::vector<Bytef> levels(count);
  uLongf size = count;
  EXPECT_EQ(uncompress(levels.data(), &size, bytes.data(), bytes.size()), Z_OK);
  EXPECT_EQ(size, count);
  return {levels.begin(), levels.end()};
}

TEST(PackedLevel, KeepsWhatWasNotSeenApartFromZero) {
  EXPECT_EQ(packed_level(kUnseen, 8), 0);
  EXPECT_EQ(packed_level(0, 8), 1);
  EXPECT_EQ(packed_level(-0.5F, 8), 1);
  EXPECT_EQ(packed_level(8, 8), kPackedLevels);
  EXPECT_EQ(packed_level(80, 8), kPackedLevels);
}

TEST(PackedLevel, IsTheNearestOfEqualSteps) {
  for (int level = 1; level <= kPackedLevels; ++level) {
    const double value = 8.0 * (level - 1) / (kPackedLevels - 1);
    EXPECT_EQ(packed_level(static_cast<float>(value + 0.03), 8), level) << "a step is 0.17";
  }
}

TEST(PackedGrid, BeginsInTheNorthWest) {
  Grid2<float> grid({0, 0}, 1, 2, 2);
  grid.at(0, 0) = 0, grid.at(1, 0) = 47;           // south
  grid.at(0, 1) = kUnseen, grid.at(1, 1) = 10.0F;  // north
  const auto packed = packed_grid(grid, 47);
  ASSERT_TRUE(packed);
  EXPECT_THAT(unpacked(*packed, 4), ElementsAre(0, 11, 1, 48));
}

TEST(PackedGrid, TakesAnEmptyGrid) { EXPECT_TRUE(packed_grid(Grid2<float>({0, 0}, 1, 0, 0), 1)); }

}  // namespace
}  // namespace rayfield::formats
