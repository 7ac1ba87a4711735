#include <gmock/gmock.h>
#include <hdf5.h>

#include "libtile/hdf5/column_codec.h"
#include "libtile/hdf5/array_image.h"
#include "libtile/tile_file/chunk_codec.h"
#include "libtile/tile_file/tile_file.h"
#include "rayfield/core/sha256.h"
#include "tests/libtile/store_support.h"

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

// Builds an HDF5 file with a column that is not data but a link, as no rayfield writes it.
std::vector<std::byte> image_with_link(bool external) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 4096, false);
  const hid_t file = H5Fcreate("link", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  const hid_t group = H5Gcreate2(file, "columns", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (external) {
    H5Lcreate_external("/etc/passwd", "/x", group, "v", H5P_DEFAULT, H5P_DEFAULT);
  } else {
    H5Lcreate_soft("/attributes", group, "v", H5P_DEFAULT, H5P_DEFAULT);
  }
  const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  const std::string text = R"({"format":"rayfield-arrays","version":1,"kind":"k","kind_version":1,"attributes":"{}"})";
  H5Tset_size(type, text.size());
  const hid_t dataset = H5Dcreate2(file, "attributes", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data());
  H5Dclose(dataset), H5Sclose(space), H5Tclose(type), H5Gclose(group);
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  std::vector<std::byte> image(static_cast<std::size_t>(H5Fget_file_image(file, nullptr, 0)));
  H5Fget_file_image(file, image.data(), image.size());
  H5Fclose(file), H5Pclose(access);
  const std::string seal = "RAYFIELD-SHA256 " + sha256_hex(image);
  for (const char c : seal) image.push_back(static_cast<std::byte>(c));
  return image;
}

TEST(StoreFile, LinksInForeignFilesAreNotFollowed) {
  for (const bool external : {false, true}) {
    const auto arrays = decode_arrays(image_with_link(external), "foreign.h5");
    ASSERT_FALSE(arrays);
    EXPECT_EQ(arrays.error().code, ErrorCode::damaged);
    EXPECT_THAT(arrays.error().line(), ::testing::HasSubstr("link"));
  }
}

TEST(StoreFile, ATileFileIsAnOrdinaryHdf5FileWithNamedColumns) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  ASSERT_TRUE(add(store, simulated_drive(1000)));
  const TileEntry tile = store.latest()->scans.at(0).tiles.at(0);
  const hid_t file = H5Fopen((store.folder() / tile.file.path).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  for (const char* name : {"columns/origin_x", "columns/origin_y", "columns/origin_z", "columns/ray_x", "columns/ray_y",
                           "columns/ray_z", "columns/time", "columns/intensity", "columns/flags"}) {
    const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
    ASSERT_GE(dataset, 0) << name;
    const hid_t space = H5Dget_space(dataset);
    EXPECT_EQ(H5Sget_simple_extent_npoints(space), static_cast<hssize_t>(tile.segment_count)) << name;
    H5Sclose(space), H5Dclose(dataset);
  }
  H5Fclose(file);
}

}  // namespace
}  // namespace rayfield::tile::testing
