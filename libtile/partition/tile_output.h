#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "libtile/tile_file/chunk_codec.h"
#include "rayfield/core/spill_file.h"
#include "rayfield/tile/snapshot.h"

namespace rayfield::tile {

/// Where the encoded chunks of a scan wait until a file's worth of them is there, and become tile files. Chunks of a
/// tile may arrive in any order; the files do not depend on it. Thread-safe.
class TileOutput {
 public:
  using WriteFile = std::function<Result<FileEntry>(TileIndex index, std::span<const std::byte> bytes)>;

  /// Up to `memory_bytes` of chunks are kept in memory, the rest in the spill file.
  TileOutput(const TileGrid& grid, SpillFile& spill, std::uint64_t memory_bytes, WriteFile write_file)
      : grid_(grid), spill_(spill), memory_bytes_(memory_bytes), write_file_(std::move(write_file)) {}

  /// Takes chunk number `chunk` of a tile; answers the part that is complete with it, if any.
  Result<std::optional<std::uint32_t>> put(std::uint32_t tile, TileIndex index, std::uint32_t chunk,
                                           EncodedChunk encoded, const ChunkSummary& summary);
  /// Builds and writes a part from its chunks.
  Result<void> write_part(std::uint32_t tile, std::uint32_t part);
  /// After the last part: the tile's entry.
  TileEntry entry(std::uint32_t tile) const;

 private:
  struct StoredChunk {
    EncodedChunk chunk;  // without bytes where these were spilled
    std::optional<SpillFile::Extent> spilled;
    bool present = false;
  };
  struct Tile {
    TileIndex index;
    std::vector<StoredChunk> chunks;
    std::vector<FileEntry> files;
    ChunkSummary summary;
  };
  Tile& tile_at(std::uint32_t tile);
  Result<std::vector<EncodedChunk>> take_chunks(std::uint32_t tile, std::uint32_t part, TileIndex& index);

  TileGrid grid_;
  SpillFile& spill_;
  std::uint64_t memory_bytes_;
  WriteFile write_file_;
  mutable std::mutex mutex_;
  std::uint64_t in_memory_ = 0;
  std::vector<std::unique_ptr<Tile>> tiles_;
};

}  // namespace rayfield::tile
