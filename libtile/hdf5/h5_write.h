#pragma once

/// hdf5: the HDF5 container of tile files and derived files. Compressed columns go in, places of compressed chunks
/// come out; no other folder calls the HDF5 library, which writes, and nothing but this folder's reader reads.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libtile/hdf5/element_type.h"
#include "rayfield/core/result.h"

/// The container (docs/store-format.md, "HDF5 files"). All calls into HDF5 are behind one lock of ours, which holds no
/// compression and no file data.
///
///   /attributes        one JSON text
///   /columns/<name>    1-D, chunked, Blosc filter
///   seal               80 bytes after the HDF5 image: "RAYFIELD-SHA256 " and the hex digest of all bytes before it
///
/// The HDF5 library only writes: what is read from a store may come from anywhere, and h5_read.h reads it.
namespace rayfield::tile {

/// A column to write; chunk c holds elements [c·chunk_elements, …), the last one padded to chunk_elements.
struct ImageColumn {
  std::string name;
  ElementType type = ElementType::u8;
  std::uint64_t count = 0;
  std::uint64_t chunk_elements = 1;  ///< ≤ count unless count == 0
  std::vector<std::span<const std::byte>> chunks;
};

/// Sealed file content. Chunks stand in the file chunk after chunk, and within a chunk column after column.
Result<std::vector<std::byte>> build_image(const std::string& attributes, const std::vector<ImageColumn>& columns);

}  // namespace rayfield::tile
