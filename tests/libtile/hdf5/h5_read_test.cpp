#include "libtile/hdf5/h5_read.h"

#include <gmock/gmock.h>

#include <array>

#include "libtile/hdf5/array_image.h"
#include "libtile/hdf5/column_codec.h"
#include "libtile/hdf5/h5_write.h"
#include "tests/libtile/hdf5/h5_reference.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::byte>;

constexpr std::array kAllTypes = {ElementType::u8,  ElementType::u16, ElementType::i32, ElementType::u32,
                                  ElementType::i64, ElementType::u64, ElementType::f32, ElementType::f64};

// An image of columns of zeros: types in turn, `chunks` chunks each.
Bytes image_of(std::size_t columns, std::size_t chunks, const std::string& attributes = "{}",
               const std::string& prefix = "column_") {
  constexpr std::size_t kElements = 16;
  std::vector<Bytes> blobs(kAllTypes.size());
  std::vector<ImageColumn> list;
  for (std::size_t k = 0; k < columns; ++k) {
    const std::size_t t = k % kAllTypes.size(), size = element_size(kAllTypes[t]);
    if (blobs[t].empty()) compress(Bytes(kElements * size), size, blobs[t]);
    ImageColumn column{prefix + std::to_string(k), kAllTypes[t], 0, kElements, {}};
    column.count = chunks * kElements - (chunks > 1 ? k % kElements : 0);  // the last chunk of several may be padded
    column.chunks.assign(chunks, blobs[t]);
    list.push_back(std::move(column));
  }
  auto image = build_image(attributes, list);
  if (!image) throw std::runtime_error(image.error().line());
  return *image;
}

void expect_same(const ImageLayout& ours, const ImageLayout& reference) {
  EXPECT_EQ(ours.attributes, reference.attributes);
  ASSERT_EQ(ours.columns.size(), reference.columns.size());
  for (std::size_t k = 0; k < ours.columns.size(); ++k) {
    const ColumnLayout &a = ours.columns[k], &b = reference.columns[k];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.type, b.type);
    EXPECT_EQ(a.count, b.count);
    EXPECT_EQ(a.chunk_elements, b.chunk_elements);
    ASSERT_EQ(a.chunks.size(), b.chunks.size());
    for (std::size_t c = 0; c < a.chunks.size(); ++c) {
      EXPECT_EQ(a.chunks[c].offset, b.chunks[c].offset);
      EXPECT_EQ(a.chunks[c].size, b.chunks[c].size);
    }
  }
}

void expect_read_as_by_library(const Bytes& image) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "image.h5";
  write_text(path, {reinterpret_cast<const char*>(image.data()), image.size()});
  const ImageLayout reference = layout_by_library(image);
  const auto from_memory = read_layout(image, "image"), from_file = read_layout(path);
  ASSERT_TRUE(from_memory) << from_memory.error().line();
  ASSERT_TRUE(from_file) << from_file.error().line();
  expect_same(*from_memory, reference);
  expect_same(*from_file, reference);
}

TEST(H5Read, AnyNumberOfColumnsIsReadAsTheLibraryReadsIt) {
  for (const std::size_t columns : {0, 1, 2, 8, 15, 16, 17, 63, 64, 65, 200, 1500})
    expect_read_as_by_library(image_of(columns, columns % 3));
}

TEST(H5Read, AnyNumberOfChunksIsReadAsTheLibraryReadsIt) {
  for (const std::size_t chunks : {0, 1, 8, 15, 16, 17, 130, 256, 257, 4000})
    expect_read_as_by_library(image_of(3, chunks));
}

TEST(H5Read, TextAndNamesOfAnyLengthAreReadAsTheLibraryReadsThem) {
  for (const std::size_t length : {0, 1, 7, 8, 2047, 2048, 100000})
    expect_read_as_by_library(image_of(2, 1, std::string(length, 'x')));
  for (const std::size_t length : {1, 8, 100, 252})
    expect_read_as_by_library(image_of(40, 1, "{}", std::string(length, 'n')));
}

TEST(H5Read, WhatTheReaderWouldRefuseIsNotWritten) {
  const Bytes blob(100);
  EXPECT_FALSE(build_image("", {{std::string(256, 'n'), ElementType::u8, 1, 1, {blob}}}));
  EXPECT_FALSE(build_image("", {{"long", ElementType::u8, 1 << 20, 1 << 20, {blob}}}));
  EXPECT_FALSE(build_image("", std::vector<ImageColumn>(4097, {"c", ElementType::u8, 0, 1, {}})));
}

TEST(H5Read, AForeignFileOfTheSameFormIsRead) {
  const Bytes image = ForeignSteps().image();
  const auto arrays = decode_arrays(image, "foreign.h5");
  ASSERT_TRUE(arrays) << arrays.error().line();
  EXPECT_EQ(*arrays->column<std::uint32_t>("v")->data(), 0U);
  expect_read_as_by_library(image);
}

TEST(H5Read, AttributesAndFilesOfOtherFormsAreRefused) {
  ForeignSteps steps;
  steps.text = [](hid_t type) { H5Tset_size(type, H5T_VARIABLE); };
  expect_refused("text of variable length", steps.image(), "not one text");
  steps.text = [](hid_t type) { H5Tset_cset(type, H5T_CSET_ASCII); };
  expect_refused("text in ASCII", steps.image(), "not one text");
  steps = {};
  steps.more = [](hid_t file) { H5Gclose(H5Gcreate2(file, "more", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)); };
  expect_refused("a third name", steps.image(), "more names");
  steps.more = [](hid_t file) { H5Ldelete(file, "attributes", H5P_DEFAULT); };
  expect_refused("no attributes", steps.image(), "does not hold");
  steps.more = [](hid_t file) { H5Ldelete(file, "columns", H5P_DEFAULT); };
  expect_refused("no columns", steps.image(), "does not hold");
  steps = {};
  steps.file = [](hid_t creation, hid_t) { H5Pset_userblock(creation, 512); };
  expect_refused("a user block", steps.image(), "not an HDF5 file as");
  steps.file = [](hid_t creation, hid_t) { H5Pset_sym_k(creation, 16, 4); };
  expect_refused("nodes of other sizes", steps.image(), "not an HDF5 file as");
  steps.file = [](hid_t creation, hid_t) { H5Pset_sizes(creation, 4, 4); };
  expect_refused("offsets of other sizes", steps.image(), "not an HDF5 file as");
  // HDF5 1.10 does not open its own images of the latest format again.
  steps.file = [](hid_t, hid_t access) { H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST); };
  EXPECT_FALSE(read_layout(steps.image(), "foreign.h5")) << "the latest format";
}

// What a stranger can do to a file that was sound, seal it again, and have it read.
TEST(H5Read, AFileCutAnywhereIsRefused) {
  const Bytes whole = image_of(3, 2);
  const ScratchFolder folder;
  for (std::size_t n = 0; n < unsealed(whole).size(); ++n) {
    const Bytes cut = resealed(std::span(whole).first(n));
    const auto layout = read_layout(cut, "cut");
    ASSERT_FALSE(layout) << n;
    EXPECT_EQ(layout.error().code, ErrorCode::damaged);
    if (n % 101 != 0) continue;
    write_text(folder.path() / "cut", {reinterpret_cast<const char*>(cut.data()), cut.size()});
    EXPECT_FALSE(read_layout(folder.path() / "cut")) << n;
  }
}

TEST(H5Read, WhateverByteIsChangedNothingOutsideOfTheFileIsNamed) {
  const Bytes whole = image_of(5, 20);
  std::size_t refused = 0;
  for (std::size_t i = 0; i < whole.size() - 80; ++i) {
    for (const std::byte mask : {std::byte{0x01}, std::byte{0x80}, std::byte{0xFF}}) {
      Bytes changed = whole;
      changed[i] ^= mask;
      changed = resealed(unsealed(changed));
      const auto layout = read_layout(changed, "changed");
      if (!layout) {
        ++refused;
        ASSERT_EQ(layout.error().code, ErrorCode::damaged);
        ASSERT_THAT(layout.error().line(), HasSubstr("changed at byte "));
        continue;
      }
      for (const ColumnLayout& column : layout->columns) {
        ASSERT_EQ(column.chunks.size(), (column.count + column.chunk_elements - 1) / column.chunk_elements);
        for (const ChunkPlace& chunk : column.chunks) {
          ASSERT_LE(chunk.offset, changed.size() - 80);
          ASSERT_LE(chunk.size, changed.size() - 80 - chunk.offset);
        }
      }
    }
  }
  EXPECT_GT(refused, 1000U);
}

}  // namespace
}  // namespace rayfield::tile::testing
