#include "libtile/partition/tile_buffers.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "libtile/files/file_io.h"

namespace rayfield::tile {
namespace {

constexpr std::size_t kBlock = RecordArena::kBlockRecords;
// 125 km² of 25 m tiles: more is a wrong CRS or unit, and its list of tiles would be a burden to everything after.
constexpr std::size_t kMaxTiles = 200000;
constexpr std::size_t kSpillBuffer = std::size_t{64} << 10;  // records

}  // namespace

bool TileBuffers::has_room(const ClippedBatch& batch) const {
  // Beyond its full blocks a group leaves one begun, and one more for each of the two chunks that it can complete.
  return arena_.free_blocks() >= batch.records.size() / kBlock + 3 * batch.groups.size();
}

Result<std::uint32_t> TileBuffers::number_of(TileIndex index) {
  const auto [it, is_new] = numbers_.try_emplace(tile_key(index), static_cast<std::uint32_t>(tiles_.size()));
  if (is_new) {
    if (tiles_.size() == kMaxTiles)
      return fail(ErrorCode::bad_input, "cannot tile the scan", "",
                  fmt::format("its rays are spread over more than {} tiles", kMaxTiles),
                  "check the cloud's coordinates and units, or use a larger tile size");
    tiles_.push_back(Tile{index, 0, {}});
  }
  return it->second;
}

void TileBuffers::append(PendingRecords& pending, std::span<const RayRecord> records) {
  while (!records.empty()) {
    if (pending.blocks.empty() || pending.in_last_block == kBlock) {
      pending.blocks.push_back(arena_.take());
      pending.in_last_block = 0;
    }
    const std::size_t n = std::min(records.size(), kBlock - pending.in_last_block);
    std::copy_n(records.begin(), n,
                arena_.records(pending.blocks.back()).begin() + static_cast<std::ptrdiff_t>(pending.in_last_block));
    pending.in_last_block += n;
    pending.count += n;
    records = records.subspan(n);
  }
}

Result<void> TileBuffers::add(const ClippedBatch& batch, std::vector<ChunkJob>& jobs) {
  for (const ClippedGroup& group : batch.groups) {
    RAYFIELD_ASSIGN(const std::uint32_t number, number_of(group.tile));
    Tile& tile = tiles_[number];
    std::span<const RayRecord> records = std::span(batch.records).subspan(group.begin, group.count);
    while (!records.empty()) {
      const std::size_t n = std::min(records.size(), kChunkSegments - tile.pending.count);
      append(tile.pending, records.first(n));
      records = records.subspan(n);
      if (tile.pending.count == kChunkSegments)
        jobs.push_back(ChunkJob{number, tile.chunks++, std::exchange(tile.pending, {})});
    }
  }
  return {};
}

// Writes all waiting records as one run, tile after tile and in pieces of up to kSpillBuffer, so that the disk sees
// long sequential writes; each tile remembers where its pieces lie, and its blocks go back to the arena.
Result<void> TileBuffers::spill() {
  std::vector<RayRecord> buffer;
  buffer.reserve(kSpillBuffer);
  struct Piece {
    Tile* tile;
    std::size_t begin, count;
  };
  std::vector<Piece> pieces;
  const auto flush = [&]() -> Result<void> {
    if (buffer.empty()) return {};
    RAYFIELD_ASSIGN(const SpillFile::Extent extent, put_aside(spill_, std::as_bytes(std::span(buffer))));
    for (const Piece& piece : pieces)
      piece.tile->pending.spilled.push_back(
          {extent.offset + piece.begin * sizeof(RayRecord), piece.count * sizeof(RayRecord)});
    buffer.clear();
    pieces.clear();
    return {};
  };
  std::vector<std::uint32_t> order(tiles_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return tiles_[a].index < tiles_[b].index; });
  for (const std::uint32_t number : order) {
    PendingRecords& pending = tiles_[number].pending;
    for (std::size_t b = 0; b < pending.blocks.size(); ++b) {
      const std::size_t n = b + 1 == pending.blocks.size() ? pending.in_last_block : kBlock;
      if (buffer.size() + n > kSpillBuffer) RAYFIELD_CHECK(flush());
      if (pieces.empty() || pieces.back().tile != &tiles_[number])
        pieces.push_back({&tiles_[number], buffer.size(), 0});
      const auto block = arena_.records(pending.blocks[b]);
      buffer.insert(buffer.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(n));
      pieces.back().count += n;
    }
    arena_.give_back(pending.blocks);
    pending.blocks.clear();
    pending.in_last_block = 0;
  }
  return flush();
}

ChunkJob TileBuffers::rest(std::size_t tile) {
  return {static_cast<std::uint32_t>(tile), tiles_[tile].chunks, std::exchange(tiles_[tile].pending, {})};
}

Result<void> TileBuffers::collect(ChunkJob& job, std::vector<RayRecord>& records) const {
  records.resize(job.records.count);
  std::size_t filled = 0;
  for (const SpillFile::Extent& extent : job.records.spilled) {
    const auto target = std::span(records).subspan(filled, extent.size / sizeof(RayRecord));
    RAYFIELD_CHECK(spill_.take(extent, std::as_writable_bytes(target)));
    filled += target.size();
  }
  for (const RecordArena::Block block : job.records.blocks) {
    const std::size_t n = std::min(kBlock, records.size() - filled);
    std::copy_n(arena_.records(block).begin(), n, records.begin() + static_cast<std::ptrdiff_t>(filled));
    filled += n;
  }
  arena_.give_back(job.records.blocks);
  job.records = {};
  return {};
}

}  // namespace rayfield::tile
