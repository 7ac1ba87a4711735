#pragma once

#include <cstddef>
#include <memory>

#include "rayfield/core/result.h"
#include "rayfield/tile/segments.h"
#include "rayfield/tile/snapshot.h"

namespace rayfield::tile {

struct OpenStore;

/// Streams a tile's segments in chunks, each decoded on its own: all but open() may be called from several threads at
/// once. Chunks hold at most 131072 segments. Made by Store::open_tile().
class TileReader {
 public:
  std::size_t chunk_count() const;
  std::size_t chunk_size(std::size_t chunk) const;  ///< segments in that chunk
  Result<void> read_chunk(std::size_t chunk, SegmentBatch& segments) const;
  /// The chunk's hits alone, in their order.
  Result<void> read_hits(std::size_t chunk, HitBatch& hits) const;

 private:
  friend class Store;
  /// Checks the tile's files against their SHA-256. Errors: damaged.
  static Result<TileReader> open(const OpenStore& store, const TileEntry& tile);

  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace rayfield::tile
