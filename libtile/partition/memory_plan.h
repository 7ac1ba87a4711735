#pragma once

#include <cstddef>
#include <cstdint>

#include "libtile/partition/clip_batch.h"

namespace rayfield::tile {

struct PartitionOptions {
  int threads = 1;
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  /// Below this the buffers cannot hold one batch of arbitrary rays.
  static constexpr std::uint64_t kLeastMemory = std::uint64_t{128} << 20;
};

/// How the memory of the partition pass is shared out.
struct MemoryPlan {
  std::size_t arena_bytes;    ///< records that wait for their chunk to fill
  std::size_t batch_rays;     ///< rays read at once
  std::size_t window;         ///< batches in flight
  std::size_t encoders;       ///< chunks encoded at once
  std::uint64_t chunk_bytes;  ///< encoded chunks that wait for their file
  ClipLimits limits;

  explicit MemoryPlan(const PartitionOptions& options);
};

}  // namespace rayfield::tile
