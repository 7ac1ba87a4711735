#include "libtile/partition/memory_plan.h"

#include <algorithm>

#include "libtile/partition/record_arena.h"

namespace rayfield::tile {

// Encoding a chunk takes about 12 MB (records, a column, the compressed chunk), a batch of rays in flight 160 B a ray
// (as read, as cut, as sorted).
MemoryPlan::MemoryPlan(const PartitionOptions& options) {
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

}  // namespace rayfield::tile
