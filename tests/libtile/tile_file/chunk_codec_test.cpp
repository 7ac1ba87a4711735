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
  const EncodedColumns columns = chunk.columns();
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

TEST(ChunkCodec, HitsComeBackAloneAsTheyDoAmidTheOtherSegments) {
  const TileGrid grid{StoreConfig{}};
  std::mt19937_64 random(9);
  std::vector<RayRecord> records(2000);
  std::vector<std::size_t> hits;
  for (std::size_t i = 0; i < records.size(); ++i) {
    RayRecord& record = records[i];
    record.geometry = {};
    for (std::size_t k = 0; k < 3; ++k) {
      record.geometry.origin[k] = static_cast<std::int32_t>(random() % 250000);
      record.geometry.ray[k] = static_cast<std::int32_t>(random() % 250000) - record.geometry.origin[k];
    }
    record.time_low = static_cast<std::uint32_t>(i), record.time_high = 0;
    record.intensity = static_cast<std::uint16_t>(i), record.flags = static_cast<std::uint8_t>(random() % 8);
    if ((record.flags & kHit) != 0) hits.push_back(i);
  }
  const EncodedChunk chunk = encode_chunk(records, 4096);
  const EncodedColumns columns = chunk.columns();
  SegmentBatch segments;
  ASSERT_TRUE(decode_chunk(columns, records.size(), 4096, {2, -3}, grid, segments, "chunk"));
  EncodedColumns wanted = columns;
  wanted[6] = wanted[7] = {};  // neither times nor intensities
  HitBatch found;
  ASSERT_TRUE(decode_hits(wanted, records.size(), 4096, {2, -3}, grid, found, "chunk"));
  ASSERT_EQ(found.size(), hits.size());
  for (std::size_t k = 0; k < hits.size(); ++k) {
    EXPECT_EQ(found.end[k], segments.exit[hits[k]]);
    EXPECT_EQ(found.flags[k], records[hits[k]].flags);
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
    EncodedChunk damaged = chunk;
    for (int flips = 0; flips < 3; ++flips)
      damaged.bytes[random() % damaged.bytes.size()] ^= static_cast<std::byte>(1U << (random() % 8));
    const EncodedColumns columns = damaged.columns();
    HitBatch hits;
    const auto decoded_hits = decode_hits(columns, records.size(), records.size(), {0, 0}, grid, hits, "chunk");
    if (!decoded_hits) {
      EXPECT_EQ(decoded_hits.error().code, ErrorCode::damaged);
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
