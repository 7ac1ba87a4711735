#include "libtile/hdf5/h5_read.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "libtile/hdf5/h5_bytes.h"
#include "libtile/hdf5/h5_group.h"
#include "libtile/hdf5/h5_layout.h"
#include "libtile/hdf5/seal.h"
#include "rayfield/core/byte_cursor.h"
#include "rayfield/core/file.h"

/// A file begins with the superblock, version 1:
///
///   signature, 8 bytes   versions u8: 1 0 0 0 0   bytes of an offset and of a length u8: 8 8   u8
///   K of symbol nodes, of group trees u16   flags u32   K of chunk trees u16   u16
///   base u64 = 0   free space u64   end of the file u64   driver u64
///   root group: name u64   object's header u64   cached u32   u32   16 bytes
namespace rayfield::tile {
namespace {

constexpr std::array<unsigned char, 16> kStart = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1A, '\n', 1, 0, 0, 0, 0, 8, 8, 0};
constexpr std::size_t kSuperblockBytes = 100;

tl::unexpected<Error> unreadable(const std::string& where, const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read file of the store", where, why, "run `rayfield verify`");
}

// The address of the root group's header.
Result<std::uint64_t> read_superblock(H5Bytes& bytes) {
  if (bytes.size() < kSuperblockBytes) return bytes.refuse(0, "it is not an HDF5 file");
  RAYFIELD_ASSIGN(const auto content, bytes.view(0, kSuperblockBytes));
  ByteCursor cursor(content);
  if (std::memcmp(cursor.take(kStart.size()).data(), kStart.data(), kStart.size()) != 0)
    return bytes.refuse(0, "it is not an HDF5 file as rayfield writes it");
  const auto symbol_k = cursor.get<std::uint16_t>(), group_k = cursor.get<std::uint16_t>();
  cursor.skip(4);
  const auto chunk_k = cursor.get<std::uint16_t>();
  cursor.skip(2);
  const auto base = cursor.get<std::uint64_t>();
  cursor.skip(8);
  const auto end = cursor.get<std::uint64_t>();
  cursor.skip(16);
  const auto root = cursor.get<std::uint64_t>();
  if (symbol_k != kSymbolNodeK || group_k != kGroupTreeK || chunk_k != kChunkTreeK || base != 0)
    return bytes.refuse(kStart.size(), "it is not an HDF5 file as rayfield writes it");
  if (end != bytes.size()) return bytes.refuse(kStart.size(), "it is not as long as it says");
  return root;
}

// The writer gives every chunk bytes of its own.
Result<void> check_disjoint(const std::vector<ColumnLayout>& columns, const H5Bytes& bytes) {
  std::vector<ChunkPlace> places;
  for (const ColumnLayout& column : columns) places.insert(places.end(), column.chunks.begin(), column.chunks.end());
  std::sort(places.begin(), places.end(), [](const ChunkPlace& a, const ChunkPlace& b) { return a.offset < b.offset; });
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i].offset - places[i - 1].offset < places[i - 1].size)
      return bytes.refuse(places[i].offset, "two chunks share bytes");
  }
  return {};
}

Result<ImageLayout> read_structure(H5Bytes bytes) {
  RAYFIELD_ASSIGN(const std::uint64_t root, read_superblock(bytes));
  RAYFIELD_ASSIGN(const std::vector<H5Name> top, read_group(bytes, root, 2));
  if (top.size() != 2 || top[0].name != kAttributesDataset || top[1].name != kColumnsGroup)
    return bytes.refuse(root, "it does not hold attributes and columns");
  ImageLayout layout;
  RAYFIELD_ASSIGN(layout.attributes, read_text(bytes, top[0].object));
  RAYFIELD_ASSIGN(const std::vector<H5Name> names, read_group(bytes, top[1].object, kMostColumns));
  std::uint64_t unclaimed = bytes.size();
  for (const H5Name& name : names) {
    RAYFIELD_ASSIGN(ColumnLayout column, read_column(bytes, name.object, name.name, unclaimed));
    layout.columns.push_back(std::move(column));
  }
  RAYFIELD_CHECK(check_disjoint(layout.columns, bytes));
  return layout;
}

}  // namespace

const ColumnLayout* ImageLayout::find(const std::string& name) const {
  const auto it = std::find_if(columns.begin(), columns.end(), [&](const ColumnLayout& c) { return c.name == name; });
  return it == columns.end() ? nullptr : &*it;
}

Result<ImageLayout> read_layout(std::span<const std::byte> image, const std::string& where) {
  if (!is_sealed(image))
    return unreadable(where, "its bytes do not agree with its seal (damaged, or not of this store)");
  return read_structure(H5Bytes(image.first(image.size() - kSealSize), where));
}

Result<ImageLayout> read_layout(const std::filesystem::path& checked_file) {
  const std::string where = checked_file.string();
  RAYFIELD_ASSIGN(const InputDescriptor input, open_regular_file(where, "cannot read file of the store"));
  if (input.size < kSealSize) return unreadable(where, "it is too short for a file of the store");
  return read_structure(H5Bytes(input.descriptor, input.size - kSealSize, where));
}

}  // namespace rayfield::tile
