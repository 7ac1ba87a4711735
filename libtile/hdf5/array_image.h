#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "libtile/hdf5/element_type.h"
#include "libtile/hdf5/h5_read.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::tile {

/// The bytes of a derived file: an HDF5 image (h5_write.h) with the columns compressed and the attributes as one JSON
/// text. `streamed`: further columns.
Result<std::vector<std::byte>> encode_arrays(const ArraySet& arrays,
                                             const std::map<std::string, ColumnSource>& streamed = {});
/// `where` is named in errors. Errors: damaged.
Result<ArraySet> decode_arrays(std::span<const std::byte> image, const std::string& where);

/// The compressed bytes of a chunk; they stay valid until the next call.
using FetchChunk = std::function<Result<std::span<const std::byte>>(const ChunkPlace& place)>;
/// Everything but the columns. Errors: damaged.
Result<ArraySet> decode_header(const ImageLayout& layout, const std::string& where);
Result<Array> decode_column(const ColumnLayout& column, const FetchChunk& fetch, const std::string& where);
/// One whole chunk, the padding of the last one with it: `bytes` has room for chunk_elements.
Result<void> decode_column_chunk(const ColumnLayout& column, std::size_t chunk, const FetchChunk& fetch,
                                 std::span<std::byte> bytes, const std::string& where);

template <class T>
constexpr ElementType type_of() {
  if constexpr (std::is_same_v<T, std::uint8_t>) return ElementType::u8;
  if constexpr (std::is_same_v<T, std::uint16_t>) return ElementType::u16;
  if constexpr (std::is_same_v<T, std::int32_t>) return ElementType::i32;
  if constexpr (std::is_same_v<T, std::uint32_t>) return ElementType::u32;
  if constexpr (std::is_same_v<T, std::int64_t>) return ElementType::i64;
  if constexpr (std::is_same_v<T, float>) return ElementType::f32;
  if constexpr (std::is_same_v<T, double>) return ElementType::f64;
}

}  // namespace rayfield::tile
