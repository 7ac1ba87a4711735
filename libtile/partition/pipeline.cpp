#include "libtile/partition/pipeline.h"

#include <algorithm>
#include <exception>
#include <new>
#include <numeric>

#include "rayfield/core/parallel.h"

namespace rayfield::tile {

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

// False: no memory is free until jobs have returned theirs.
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
  ChunkJob job = std::move(chunk_jobs_.front().first);
  const TileIndex index = chunk_jobs_.front().second;
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

}  // namespace rayfield::tile
