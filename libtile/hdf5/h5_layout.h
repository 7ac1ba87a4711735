#pragma once

#include <cstddef>

/// What writer (h5_write.h) and reader (h5_read.h) of the container agree on (docs/store-format.md, "HDF5 structures").
namespace rayfield::tile {

inline constexpr const char* kAttributesDataset = "attributes";
inline constexpr const char* kColumnsGroup = "columns";

/// Half of the entries that a node has room for, which is what HDF5 calls K. Nodes are small: a part of a tile has few
/// chunks, and a small tile should be a small file.
inline constexpr std::size_t kSymbolNodeK = 8, kGroupTreeK = 4, kChunkTreeK = 8;

/// Elements of a chunk at most: what one chunk decompresses to is bounded whatever a file claims.
inline constexpr std::size_t kMostChunkElements = 131072;

inline constexpr std::size_t kMostColumns = 4096, kMostNameBytes = 255;

}  // namespace rayfield::tile
