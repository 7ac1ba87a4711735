#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "libtile/hdf5/h5_bytes.h"
#include "rayfield/core/result.h"

namespace rayfield::tile {

/// What a version 1 B-tree leads to; the value stands in its nodes.
enum class H5TreeKind : std::uint8_t {
  names = 0,   ///< symbol table nodes of a group
  chunks = 1,  ///< chunks of a column
};

/// An entry of a leaf. The key's bytes are valid during the call.
struct H5TreeEntry {
  std::uint64_t offset = 0;  ///< of the key, in the file
  std::span<const std::byte> key;
  std::uint64_t child = 0;  ///< address of what the entry leads to
};

/// Calls `visit` with every entry of the tree's leaves, in the tree's order, and stops at the first error. Levels have
/// to fall by one from node to child, so that a loop of addresses ends; a visitor that insists on rising keys ends the
/// walk of a tree that leads to one node many times. Errors: damaged; those of `visit`.
Result<void> walk_tree(H5Bytes& bytes, std::uint64_t root, H5TreeKind kind,
                       const std::function<Result<void>(const H5TreeEntry&)>& visit);

}  // namespace rayfield::tile
