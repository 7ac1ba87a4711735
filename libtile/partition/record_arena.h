#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "libtile/tile_file/chunk_codec.h"
#include "rayfield/core/result.h"

namespace rayfield::tile {

/// A fixed amount of memory cut into blocks of records: what tiles hold of it is bounded exactly, whatever the number
/// of tiles and the order of the rays. Pages that were never used cost nothing. Thread-safe.
class RecordArena {
 public:
  static constexpr std::size_t kBlockRecords = 32;
  using Block = std::uint32_t;

  /// Errors: resources.
  static Result<RecordArena> create(std::size_t bytes);
  RecordArena(RecordArena&& other) noexcept;
  RecordArena& operator=(RecordArena&&) = delete;
  ~RecordArena();

  std::size_t free_blocks() const;
  /// The caller has made sure that a block is free.
  Block take();
  void give_back(std::span<const Block> blocks);
  std::span<RayRecord, kBlockRecords> records(Block block) const {
    return std::span<RayRecord, kBlockRecords>(memory_ + std::size_t{block} * kBlockRecords, kBlockRecords);
  }

 private:
  RecordArena(RayRecord* memory, std::size_t blocks) : memory_(memory), block_count_(blocks) {}
  RayRecord* memory_;
  std::size_t block_count_;
  mutable std::mutex mutex_;
  std::vector<Block> returned_;  // used again first: their pages are there already
  Block never_used_ = 0;
};

}  // namespace rayfield::tile
