#pragma once

/// partition: cuts a stream of rays into tile files with bounded memory.

#include <vector>

#include "libtile/partition/clip_batch.h"
#include "libtile/partition/memory_plan.h"
#include "libtile/partition/tile_output.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/ray_source.h"

namespace rayfield::tile {

struct PartitionResult {
  RayStatistics statistics;
  std::vector<TileEntry> tiles;  ///< ordered by index
};

/// Cuts a stream of rays into tile files in one reading of the stream. Bytes and order of the files depend on the rays
/// and the grid only. `spill` takes what does not fit in memory. Errors: what the source, the disk or the rays give;
/// interrupted.
Result<PartitionResult> partition(RaySource& rays, const TileGrid& grid, const PartitionOptions& options,
                                  SpillFile& spill, const TileOutput::WriteFile& write_file, Progress& progress);

}  // namespace rayfield::tile
