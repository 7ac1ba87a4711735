#include <gmock/gmock.h>

#include "libtile/tile_file/chunk_codec.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

TEST(ChunkCodec, RandomIntegersOfFullRangeComeBackExactly) {
  const TileGrid grid{StoreConfig{}};
  std::mt19937_64 random(8);
  std::vector<RayRecord> records(3001);
  for (RayRecord& record : records) {
    for (std::size_t k = 0; k < 3; ++k) {
      record.geometry.origin[k] = static_cast<std::int32_t>(random() % 250000);
      record.geometry.ray[k] = 0;
    }
    record.geometry.origin[2] = static_cast<std::int32_t>(random() % 2000000000) - 1000000000;
    record.geometry.ray[2] = static_cast<std::int32_t>(random() % 90000000) - 45000000;
    record.time_low = static_cast<std::uint32_t>(random());
    record.time_high = static_cast<std::uint32_t>(random() % 0x10000);
    record.intensity = static_cast<std::uint16_t>(random());
    record.flags = static_cast<std::uint8_t>(random() % 8);
  }
  const EncodedChunk chunk = encode_chunk(records, 4096);
  std::array<std::span<const std::byte>, kColumnCount> columns;
  std::size_t offset = 0;
  for (std::size_t k = 0; k < kColumnCount; ++k) {
    columns[k] = std::span(chunk.bytes).subspan(offset, chunk.sizes[k]);
    offset += chunk.sizes[k];
  }
  SegmentBatch segments;
  ASSERT_TRUE(decode_chunk(columns, records.size(), 4096, {2, -3}, grid, segments, "chunk"));
  ASSERT_EQ(segments.size(), records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto& origin = records[i].geometry.origin;
    EXPECT_EQ(segments.entry[i].x(), static_cast<double>(500000 + origin[0]) / 1e4);
    EXPECT_EQ(segments.entry[i].y(), static_cast<double>(-750000 + origin[1]) / 1e4);
    EXPECT_EQ(segments.entry[i].z(), static_cast<double>(origin[2]) / 1e4);
    EXPECT_EQ(segments.exit[i].z(), static_cast<double>(origin[2] + std::int64_t{records[i].geometry.ray[2]}) / 1e4);
    const auto time = static_cast<std::int64_t>((std::uint64_t{records[i].time_high} << 32U) | records[i].time_low);
    EXPECT_EQ(segments.time_s[i], static_cast<double>(time) / 1e6);
    EXPECT_EQ(segments.intensity[i], records[i].intensity);
    EXPECT_EQ(segments.flags[i], records[i].flags);
  }
}

TEST(ChunkCodec, DamagedColumnsGiveAnErrorOrValuesButNeverACrash) {
  const TileGrid grid{StoreConfig{}};
  std::vector<RayRecord> records(500);
  for (std::size_t i = 0; i < records.size(); ++i) records[i].geometry.ray[0] = static_cast<std::int32_t>(i * i);
  const EncodedChunk chunk = encode_chunk(records, records.size());
  SegmentBatch segments;
  std::mt19937 random(2);
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::byte> bytes = chunk.bytes;
    for (int flips = 0; flips < 3; ++flips)
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1U << (random() % 8));
    std::array<std::span<const std::byte>, kColumnCount> columns;
    std::size_t offset = 0;
    for (std::size_t k = 0; k < kColumnCount; ++k) {
      columns[k] = std::span<const std::byte>(bytes).subspan(offset, chunk.sizes[k]);
      offset += chunk.sizes[k];
    }
    const auto decoded = decode_chunk(columns, records.size(), records.size(), {0, 0}, grid, segments, "chunk");
    if (decoded) {
      EXPECT_EQ(segments.size(), records.size());
    } else {
      EXPECT_EQ(decoded.error().code, ErrorCode::damaged);
    }
  }
}

}  // namespace
}  // namespace rayfield::tile::testing
