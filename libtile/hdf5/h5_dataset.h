#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libtile/hdf5/element_type.h"
#include "libtile/hdf5/h5_bytes.h"
#include "rayfield/core/result.h"

namespace rayfield::tile {

struct ChunkPlace {
  std::uint64_t offset = 0, size = 0;  ///< bytes, in the file
};

struct ColumnLayout {
  std::string name;
  ElementType type = ElementType::u8;
  std::uint64_t count = 0;
  std::uint64_t chunk_elements = 1;
  std::vector<ChunkPlace> chunks;  ///< as many as `count` takes
};

/// The text of the dataset whose header is at `offset`: one string of fixed length, stored in one piece.
/// Errors: damaged.
Result<std::string> read_text(H5Bytes& bytes, std::uint64_t offset);

/// Type, length and chunks of a column: a list of numbers, in chunks with the Blosc filter, or empty. `unclaimed` is
/// how many bytes of the file may be chunks; what the column's chunks take is taken off, so that many columns cannot
/// claim the same chunks, and more memory than the file has bytes. Errors: damaged.
Result<ColumnLayout> read_column(H5Bytes& bytes, std::uint64_t offset, const std::string& name,
                                 std::uint64_t& unclaimed);

}  // namespace rayfield::tile
