#include "libtile/partition/tile_output.h"

#include <algorithm>

#include "libtile/files/file_io.h"
#include "libtile/tile_file/tile_file.h"

namespace rayfield::tile {

TileOutput::Tile& TileOutput::tile_at(std::uint32_t tile) {
  while (tiles_.size() <= tile) tiles_.push_back(std::make_unique<Tile>());
  return *tiles_[tile];
}

Result<std::optional<std::uint32_t>> TileOutput::put(std::uint32_t tile, TileIndex index, std::uint32_t chunk,
                                                     EncodedChunk encoded, const ChunkSummary& summary) {
  std::optional<SpillFile::Extent> spilled;
  bool keep = false;
  {
    const std::lock_guard lock(mutex_);
    keep = in_memory_ + encoded.bytes.size() <= memory_bytes_;
    if (keep) in_memory_ += encoded.bytes.size();
  }
  if (!keep) {
    RAYFIELD_ASSIGN(spilled, put_aside(spill_, encoded.bytes));
    encoded.bytes = {};
  }
  const std::lock_guard lock(mutex_);
  Tile& state = tile_at(tile);
  state.index = index;
  if (state.chunks.size() <= chunk) state.chunks.resize(chunk + 1);
  state.chunks[chunk] = StoredChunk{std::move(encoded), spilled, true};
  state.summary.add(summary);
  const std::uint32_t part = chunk / static_cast<std::uint32_t>(kChunksPerPart);
  const std::size_t first = std::size_t{part} * kChunksPerPart;
  if (state.chunks.size() < first + kChunksPerPart) return std::nullopt;
  const auto begin = state.chunks.begin() + static_cast<std::ptrdiff_t>(first);
  const bool complete = std::all_of(begin, begin + kChunksPerPart, [](const StoredChunk& c) { return c.present; });
  return complete ? std::optional(part) : std::nullopt;
}

Result<std::vector<EncodedChunk>> TileOutput::take_chunks(std::uint32_t tile, std::uint32_t part, TileIndex& index) {
  std::vector<StoredChunk> stored;
  {
    const std::lock_guard lock(mutex_);
    Tile& state = tile_at(tile);
    index = state.index;
    const std::size_t first = std::size_t{part} * kChunksPerPart;
    const std::size_t last = std::min(first + kChunksPerPart, state.chunks.size());
    for (std::size_t c = first; c < last; ++c) {
      in_memory_ -= state.chunks[c].chunk.bytes.size();
      stored.push_back(std::move(state.chunks[c]));
      state.chunks[c] = StoredChunk{};
    }
  }
  std::vector<EncodedChunk> chunks;
  for (StoredChunk& c : stored) {
    if (c.spilled) {
      c.chunk.bytes.resize(c.spilled->size);
      RAYFIELD_CHECK(spill_.take(*c.spilled, c.chunk.bytes));
    }
    chunks.push_back(std::move(c.chunk));
  }
  return chunks;
}

Result<void> TileOutput::write_part(std::uint32_t tile, std::uint32_t part) {
  TilePartHeader header;
  std::vector<std::byte> bytes;
  {
    RAYFIELD_ASSIGN(const std::vector<EncodedChunk> chunks, take_chunks(tile, part, header.index));
    header.part = part;
    header.size = grid_.size;
    header.margin = grid_.margin;
    for (const EncodedChunk& chunk : chunks) header.segments += chunk.count;
    RAYFIELD_ASSIGN(bytes, build_tile_part(header, chunks));
  }
  RAYFIELD_ASSIGN(FileEntry file, write_file_(header.index, bytes));
  const std::lock_guard lock(mutex_);
  std::vector<FileEntry>& files = tile_at(tile).files;
  if (files.size() <= part) files.resize(part + 1);
  files[part] = std::move(file);
  return {};
}

TileEntry TileOutput::entry(std::uint32_t tile) const {
  const std::lock_guard lock(mutex_);
  const Tile& state = *tiles_[tile];
  TileEntry entry;
  entry.index = state.index;
  entry.file = state.files.front();
  entry.more_files.assign(state.files.begin() + 1, state.files.end());
  entry.segment_count = state.summary.segments;
  entry.start_count = state.summary.starts;
  entry.hit_count = state.summary.hits;
  entry.bounds = state.summary.bounds;
  return entry;
}

}  // namespace rayfield::tile
