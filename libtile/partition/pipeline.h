#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "libtile/partition/clip_batch.h"
#include "libtile/partition/memory_plan.h"
#include "libtile/partition/tile_buffers.h"
#include "libtile/partition/tile_output.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/ray_source.h"

namespace rayfield::tile {

/// The workers of a partition. Each takes the most urgent thing that can be done: distribute the oldest batch (one at
/// a time, in the order of the scan, which is what makes the result independent of the threads), encode a chunk, write
/// a file, clip a batch, read the next batch (one at a time).
class Pipeline {
 public:
  Pipeline(RaySource& rays, const TileGrid& grid, const PartitionOptions& options, SpillFile& spill, RecordArena& arena,
           TileOutput& output, Progress& progress)
      : rays_(rays),
        grid_(grid),
        threads_(options.threads),
        plan_(options),
        arena_(arena),
        buffers_(arena, spill),
        output_(output),
        progress_(progress) {}

  Result<void> run();
  /// After run(): encodes what is left of each tile and writes its last file.
  Result<std::vector<TileEntry>> finish();
  const RayStatistics& statistics() const { return statistics_; }

 private:
  struct Item {
    enum class State { read, clipping, clipped, distributing } state = State::read;
    RayBatch rays;
    ClippedBatch clipped;
    std::size_t next_ray = 0;
  };
  struct PartJob {
    std::uint32_t tile, part;
  };
  using Lock = std::unique_lock<std::mutex>;

  void work();
  bool try_distribute(Lock& lock);
  bool try_encode(Lock& lock);
  bool try_write(Lock& lock);
  bool try_clip(Lock& lock, BatchClipper& clipper);
  bool try_read(Lock& lock);
  Result<bool> distribute(Item& item, bool jobs_outstanding, std::vector<ChunkJob>& jobs);
  Result<std::optional<std::uint32_t>> encode(ChunkJob& job, TileIndex index, std::size_t chunk_elements);
  Result<TileEntry> finish_tile_of(std::uint32_t tile);
  tl::unexpected<Error> interrupted() const {
    return fail(ErrorCode::interrupted, "interrupted", rays_.name(), "the store is as it was",
                "run the same command again to start over");
  }
  template <class F>
  void unlocked(Lock& lock, F&& action);
  bool idle() const {
    return end_of_rays_ && items_.empty() && chunk_jobs_.empty() && part_jobs_.empty() && encoding_ == 0 && !writing_;
  }

  RaySource& rays_;
  TileGrid grid_;
  int threads_;
  MemoryPlan plan_;
  RecordArena& arena_;
  TileBuffers buffers_;
  TileOutput& output_;
  Progress& progress_;
  RayStatistics statistics_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::unique_ptr<Item>> items_;
  std::vector<std::unique_ptr<Item>> spare_items_;
  std::deque<std::pair<ChunkJob, TileIndex>> chunk_jobs_;
  std::deque<PartJob> part_jobs_;
  bool reading_ = false, end_of_rays_ = false, distributing_ = false, no_room_ = false, writing_ = false;
  std::size_t encoding_ = 0;
  std::optional<Error> error_;
};

}  // namespace rayfield::tile
