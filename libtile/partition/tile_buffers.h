#pragma once

#include <unordered_map>
#include <vector>

#include "libtile/partition/clip_batch.h"
#include "libtile/partition/record_arena.h"
#include "rayfield/core/spill_file.h"

namespace rayfield::tile {

/// Records of one tile that wait to become a chunk: on the disk, then in the arena; in the order of the scan.
struct PendingRecords {
  std::vector<SpillFile::Extent> spilled;
  std::vector<RecordArena::Block> blocks;
  std::size_t in_last_block = 0;  ///< records in blocks.back(); all blocks before are full
  std::size_t count = 0;          ///< spilled and in blocks
};

/// Records of a full chunk on their way to encoding.
struct ChunkJob {
  std::uint32_t tile = 0;   ///< number of the tile, in the order of first appearance
  std::uint32_t chunk = 0;  ///< within the tile
  PendingRecords records;
};

/// Sorts the clipped rays of a scan into tiles, with bounded memory: an external sort. Records collect per tile in an
/// arena; a tile's records leave as a job when they fill a chunk; when the arena is full, all that is in it goes to the
/// spill file as one run ordered by tile. Rays in the order of a drive are written once at most, rays in random order
/// cost large sequential writes instead of a seek each. Not thread-safe, except collect().
class TileBuffers {
 public:
  TileBuffers(RecordArena& arena, SpillFile& spill) : arena_(arena), spill_(spill) {}

  /// Whether the arena can take that batch now; where not, spill() makes room of what is not in jobs.
  bool has_room(const ClippedBatch& batch) const;
  Result<void> spill();
  /// Adds a batch for which there is room; full chunks are appended to `jobs`. Errors: bad_input (too many tiles).
  Result<void> add(const ClippedBatch& batch, std::vector<ChunkJob>& jobs);

  std::size_t tile_count() const { return tiles_.size(); }
  TileIndex index(std::size_t tile) const { return tiles_[tile].index; }
  /// What is left of a tile after the last batch.
  ChunkJob rest(std::size_t tile);

  /// Brings a job's records together and frees where they were.
  Result<void> collect(ChunkJob& job, std::vector<RayRecord>& records) const;

 private:
  struct Tile {
    TileIndex index;
    std::uint32_t chunks = 0;
    PendingRecords pending;
  };
  Result<std::uint32_t> number_of(TileIndex index);
  void append(PendingRecords& pending, std::span<const RayRecord> records);

  RecordArena& arena_;
  SpillFile& spill_;
  std::vector<Tile> tiles_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
};

}  // namespace rayfield::tile
