#include "libtile/hdf5/column_codec.h"

#include <gtest/gtest.h>

#include <random>

namespace rayfield::tile::testing {
namespace {

TEST(ColumnCodec, ZigzagKeepsEveryValueIncludingTheExtremes) {
  for (const std::uint32_t v : {0U, 1U, 0xFFFFFFFFU, 0x7FFFFFFFU, 0x80000000U, 12345U})
    EXPECT_EQ(unzigzag(zigzag(v)), v);
  for (const std::uint64_t v : {std::uint64_t{0}, ~std::uint64_t{0}, std::uint64_t{1} << 63U})
    EXPECT_EQ(unzigzag(zigzag(v)), v);
  EXPECT_EQ(zigzag(static_cast<std::uint32_t>(-1)), 1U);
  EXPECT_EQ(zigzag(1U), 2U);
}

TEST(ColumnCodec, BytesThatCannotBeCompressedComeBack) {
  std::mt19937 random(5);
  std::vector<std::uint32_t> noise(5000), back(noise.size());
  for (auto& v : noise) v = static_cast<std::uint32_t>(random());
  std::vector<std::byte> blob;
  compress(std::as_bytes(std::span(noise)), 4, blob);
  EXPECT_TRUE(decompress(blob, std::as_writable_bytes(std::span(back))));
  EXPECT_EQ(back, noise);
}

TEST(ColumnCodec, ABufferOfAnotherSizeOrCutShortIsRefused) {
  std::vector<std::uint32_t> values(1000, 7), back(1000);
  std::vector<std::byte> blob;
  compress(std::as_bytes(std::span(values)), 4, blob);
  EXPECT_FALSE(decompress(blob, std::as_writable_bytes(std::span(back)).first(3996)));
  for (std::size_t n = 0; n < blob.size(); ++n)
    EXPECT_FALSE(decompress(std::span(blob).first(n), std::as_writable_bytes(std::span(back)))) << n;
}

}  // namespace
}  // namespace rayfield::tile::testing
