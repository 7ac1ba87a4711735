#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "rayfield/core/parallel.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// Feeds every chunk of a tile to one of several accumulators (copies of `empty`, one per worker) and merges them.
/// `Accumulator` has add(const SegmentBatch&) and merge(const Accumulator&), both independent of the order of calls.
template <class Accumulator>
Result<Accumulator> accumulate_chunks(const tile::Store::TileReader& reader, const Accumulator& empty, int threads) {
  const std::size_t chunks = reader.chunk_count();
  const int workers = std::max(1, std::min<int>(thread_count(threads), static_cast<int>(chunks)));
  std::vector<Accumulator> parts(static_cast<std::size_t>(workers), empty);
  std::vector<tile::SegmentBatch> batches(static_cast<std::size_t>(workers));
  const auto add_chunk = [&](std::size_t chunk, int worker) -> Result<void> {
    const std::size_t w = static_cast<std::size_t>(worker);
    RAYFIELD_CHECK(reader.read_chunk(chunk, batches[w]));
    parts[w].add(batches[w]);
    return {};
  };
  RAYFIELD_CHECK(parallel_for(chunks, workers, add_chunk));
  for (std::size_t w = 1; w < parts.size(); ++w) parts[0].merge(parts[w]);
  return std::move(parts[0]);
}

}  // namespace rayfield::density
