#include "libdensity/tiles/accumulate.h"

#include <algorithm>

#include "rayfield/core/parallel.h"

namespace rayfield::density {

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
                        const std::function<Result<void>(const tile::SegmentBatch& segments, int worker)>& add,
                        std::size_t every) {
  std::vector<tile::SegmentBatch> batches(static_cast<std::size_t>(workers));
  const std::size_t count = (reader.chunk_count() + every - 1) / every;
  return parallel_for(count, workers, [&](std::size_t i, int worker) -> Result<void> {
    tile::SegmentBatch& batch = batches[worker];
    RAYFIELD_CHECK(check_cancelled(progress));
    RAYFIELD_CHECK(reader.read_chunk(i * every, batch));
    return add(batch, worker);
  });
}

}  // namespace rayfield::density
