#include "libdensity/tiles/accumulate.h"

#include <algorithm>

#include "rayfield/core/parallel.h"

namespace rayfield::density {
namespace {

// Reads one batch after the other into one per worker, and passes them on.
template <class Batch, class Read, class Add>
Result<void> for_batches(std::size_t count, int workers, const Progress& progress, const Read& read, const Add& add) {
  std::vector<Batch> batches(static_cast<std::size_t>(workers));
  return parallel_for(count, workers, [&](std::size_t i, int worker) -> Result<void> {
    Batch& batch = batches[static_cast<std::size_t>(worker)];
    RAYFIELD_CHECK(check_cancelled(progress));
    RAYFIELD_CHECK(read(i, batch));
    return add(batch, worker);
  });
}

}  // namespace

Result<void> check_cancelled(const Progress& progress) {
  if (progress.cancelled())
    return fail(ErrorCode::interrupted, "interrupted", "", "finished files are kept",
                "run the same command again to go on");
  return {};
}

int chunk_workers(const tile::Store::TileReader& reader, int threads) {
  return std::max(1, std::min(thread_count(threads), static_cast<int>(reader.chunk_count())));
}

Result<void> for_chunks(const tile::Store::TileReader& reader, int workers, const Progress& progress,
                        const AddSegments& add, std::size_t every) {
  const std::size_t count = (reader.chunk_count() + every - 1) / every;
  return for_batches<tile::SegmentBatch>(
      count, workers, progress,
      [&](std::size_t i, tile::SegmentBatch& batch) { return reader.read_chunk(i * every, batch); }, add);
}

Result<void> for_hits(const tile::Store::TileReader& reader, int workers, const Progress& progress,
                      const AddHits& add) {
  return for_batches<tile::HitBatch>(
      reader.chunk_count(), workers, progress,
      [&](std::size_t chunk, tile::HitBatch& batch) { return reader.read_hits(chunk, batch); }, add);
}

}  // namespace rayfield::density
