#include "libtile/partition/partition.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <numeric>

#include "libtile/partition/tile_buffers.h"
#include "rayfield/core/parallel.h"

namespace rayfield::tile {
namespace {

/// How the memory of the partition pass is shared out. A job of encoding takes about 12 MB (records, a column, the
/// compressed chunk), a batch of rays in flight 160 B a ray (as read, as cut, as sorted).
struct MemoryPlan {
  std::size_t arena_bytes, batch_rays, window, encoders;
  std::uint64_t chunk_bytes;
  ClipLimits limits;

  explicit MemoryPlan(const PartitionOptions& options) {
    const std::uint64_t memory = options.memory_bytes;
    const auto threads = static_cast<std::size_t>(options.threads);
    arena_bytes = memory / 8 * 3;
    chunk_bytes = memory / 8;
    encoders = std::clamp<std::size_t>(memory / 4 / (std::size_t{12} << 20), 1, threads);
    window = threads + 2;
    batch_rays = std::clamp<std::size_t>(memory / 8 / window / 160, 1024, std::size_t{1} << 16);
    const std::size_t blocks = arena_bytes / (RecordArena::kBlockRecords * sizeof(RayRecord));
    limits.records = std::min(4 * batch_rays, blocks / 4 * RecordArena::kBlockRecords);
    limits.groups = std::min<std::size_t>(4096, blocks / 8);
  }
};

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

// Runs an action without the lock; its failure, or what it throws, ends the pipeline.
template <class F>
void Pipeline::unlocked(Lock& lock, F&& action) {
  lock.unlock();
  Result<void> result;
  try {
    result = action();
  } catch (const std::bad_alloc&) {
    result = fail(ErrorCode::resources, "cannot tile the scan", rays_.name(), "out of memory",
                  "give a smaller --memory or fewer --threads");
  } catch (const std::exception& e) {
    result = fail(ErrorCode::internal, "cannot tile the scan", rays_.name(), e.what(),
                  "please report this with the command line");
  }
  lock.lock();
  if (!result && !error_) error_ = std::move(result).error();
  changed_.notify_all();
}

bool Pipeline::try_distribute(Lock& lock) {
  if (distributing_ || items_.empty() || items_.front()->state != Item::State::clipped) return false;
  const bool jobs_outstanding = !chunk_jobs_.empty() || encoding_ > 0;
  if (no_room_ && jobs_outstanding) return false;
  distributing_ = true;
  Item& item = *items_.front();
  item.state = Item::State::distributing;
  std::vector<ChunkJob> jobs;
  std::vector<TileIndex> indices;
  bool done = false;
  unlocked(lock, [&]() -> Result<void> {
    RAYFIELD_ASSIGN(done, distribute(item, jobs_outstanding, jobs));
    for (const ChunkJob& job : jobs) indices.push_back(buffers_.index(job.tile));
    return {};
  });
  distributing_ = false;
  no_room_ = !done;
  item.state = Item::State::clipped;
  for (std::size_t j = 0; j < indices.size(); ++j) chunk_jobs_.emplace_back(std::move(jobs[j]), indices[j]);
  if (!done) return true;
  item.next_ray = item.clipped.next_ray;
  item.state = Item::State::read;  // where a limit stopped the clipping, the rest of the batch comes first
  if (item.next_ray >= item.rays.size()) {
    spare_items_.push_back(std::move(items_.front()));
    items_.pop_front();
  }
  return true;
}

// False: there is no room until jobs have given theirs back.
Result<bool> Pipeline::distribute(Item& item, bool jobs_outstanding, std::vector<ChunkJob>& jobs) {
  if (!buffers_.has_room(item.clipped)) RAYFIELD_CHECK(buffers_.spill());
  if (!buffers_.has_room(item.clipped)) {
    if (jobs_outstanding) return false;
    return fail(ErrorCode::internal, "cannot tile the scan", rays_.name(), "the buffers do not hold one batch",
                "give a larger --memory");
  }
  RAYFIELD_CHECK(buffers_.add(item.clipped, jobs));
  statistics_.merge(item.clipped.statistics);
  progress_.advance(item.clipped.next_ray - item.next_ray);
  return true;
}

bool Pipeline::try_encode(Lock& lock) {
  if (chunk_jobs_.empty() || encoding_ >= plan_.encoders) return false;
  auto [job, index] = std::move(chunk_jobs_.front());
  chunk_jobs_.pop_front();
  ++encoding_;
  std::optional<std::uint32_t> complete;
  unlocked(lock, [&, index = index]() -> Result<void> {
    RAYFIELD_ASSIGN(complete, encode(job, index, kChunkSegments));
    return {};
  });
  --encoding_;
  if (complete) part_jobs_.push_back({job.tile, *complete});
  return true;
}

Result<std::optional<std::uint32_t>> Pipeline::encode(ChunkJob& job, TileIndex index, std::size_t chunk_elements) {
  EncodedChunk encoded;
  ChunkSummary summary;
  {
    std::vector<RayRecord> records;
    RAYFIELD_CHECK(buffers_.collect(job, records));
    summary = summarize(records, index, grid_);
    encoded = encode_chunk(records, std::max(chunk_elements, records.size()));
  }
  return output_.put(job.tile, index, job.chunk, std::move(encoded), summary);
}

bool Pipeline::try_write(Lock& lock) {
  if (part_jobs_.empty() || writing_) return false;
  const PartJob job = part_jobs_.front();
  part_jobs_.pop_front();
  writing_ = true;
  unlocked(lock, [&] { return output_.write_part(job.tile, job.part); });
  writing_ = false;
  return true;
}

bool Pipeline::try_clip(Lock& lock, BatchClipper& clipper) {
  const auto it =
      std::find_if(items_.begin(), items_.end(), [](const auto& i) { return i->state == Item::State::read; });
  if (it == items_.end()) return false;
  Item& item = **it;
  item.state = Item::State::clipping;
  unlocked(lock, [&]() -> Result<void> {
    clipper.clip(item.rays, item.next_ray, plan_.limits, item.clipped);
    return {};
  });
  item.state = Item::State::clipped;
  return true;
}

bool Pipeline::try_read(Lock& lock) {
  if (reading_ || end_of_rays_ || items_.size() >= plan_.window) return false;
  reading_ = true;
  std::unique_ptr<Item> item;
  if (spare_items_.empty()) {
    item = std::make_unique<Item>();
  } else {
    item = std::move(spare_items_.back());
    spare_items_.pop_back();
  }
  std::size_t count = 0;
  unlocked(lock, [&]() -> Result<void> {
    if (progress_.cancelled()) return interrupted();
    RAYFIELD_ASSIGN(count, rays_.read(item->rays, plan_.batch_rays));
    return {};
  });
  reading_ = false;
  if (count == 0) {
    end_of_rays_ = true;
    return true;
  }
  item->state = Item::State::read;
  item->next_ray = 0;
  items_.push_back(std::move(item));
  return true;
}

void Pipeline::work() {
  BatchClipper clipper(grid_);
  Lock lock(mutex_);
  while (!error_ && !idle()) {
    if (try_distribute(lock) || try_encode(lock) || try_write(lock) || try_clip(lock, clipper) || try_read(lock))
      continue;
    changed_.wait(lock);
  }
  changed_.notify_all();
}

Result<void> Pipeline::run() {
  parallel_team(threads_, [this](int) { work(); });
  if (error_) return tl::make_unexpected(*error_);
  return {};
}

Result<TileEntry> Pipeline::finish_tile_of(std::uint32_t tile) {
  ChunkJob job = buffers_.rest(tile);
  const std::uint32_t part = job.chunk / static_cast<std::uint32_t>(kChunksPerPart);
  const bool begins_part = job.chunk % kChunksPerPart == 0;
  const bool has_rest = job.records.count > 0;
  // The first chunk of a file is as long as it needs to be; the others are padded to its length.
  if (has_rest) RAYFIELD_CHECK(encode(job, buffers_.index(tile), begins_part ? job.records.count : kChunkSegments));
  if (has_rest || !begins_part) RAYFIELD_CHECK(output_.write_part(tile, part));
  return output_.entry(tile);
}

Result<std::vector<TileEntry>> Pipeline::finish() {
  std::vector<std::uint32_t> order(buffers_.tile_count());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return buffers_.index(a) < buffers_.index(b); });
  progress_.stage("writing tiles", order.size(), "tiles");
  std::vector<TileEntry> entries(order.size());
  const auto finish_tile = [&](std::size_t i, int) -> Result<void> {
    if (progress_.cancelled()) return interrupted();
    RAYFIELD_ASSIGN(entries[i], finish_tile_of(order[i]));
    progress_.advance(1);
    return {};
  };
  RAYFIELD_CHECK(parallel_for(order.size(), static_cast<int>(plan_.encoders), finish_tile));
  return entries;
}

// Errors where the rays are such that no map can come of them.
Result<void> check_rays(const RayStatistics& statistics, const std::string& name) {
  if (statistics.rays == 0 && statistics.dropped() == 0)
    return fail(ErrorCode::bad_input, "cannot tile the scan", name, "it holds no rays", "give a cloud with rays in it");
  if (statistics.rays == 0)
    return fail(ErrorCode::bad_input, "cannot tile the scan", name,
                "none of its rays is usable (coordinates are not finite, out of range, or rays are over 5 km long)",
                "check the cloud and its CRS");
  if (!statistics.any_length)
    return fail(ErrorCode::bad_input, "cannot tile the scan", name,
                "all rays have zero length: the cloud does not say where rays start",
                "give a ray cloud, in which nx ny nz lead from the point to the sensor");
  if (statistics.rays > 1 && statistics.all_identical)
    return fail(ErrorCode::bad_input, "cannot tile the scan", name, "all rays are identical", "check the cloud");
  return {};
}

}  // namespace

Result<PartitionResult> partition(RaySource& rays, const TileGrid& grid, const PartitionOptions& options,
                                  SpillFile& spill, const TileOutput::WriteFile& write_file, Progress& progress) {
  RAYFIELD_ASSIGN(RecordArena arena, RecordArena::create(MemoryPlan(options).arena_bytes));
  TileOutput output(grid, spill, MemoryPlan(options).chunk_bytes, write_file);
  Pipeline pipeline(rays, grid, options, spill, arena, output, progress);
  progress.stage("tiling", rays.ray_count().value_or(0), "rays");
  RAYFIELD_CHECK(pipeline.run());
  PartitionResult result;
  result.statistics = pipeline.statistics();
  RAYFIELD_CHECK(check_rays(result.statistics, rays.name()));
  RAYFIELD_ASSIGN(result.tiles, pipeline.finish());
  return result;
}

}  // namespace rayfield::tile
