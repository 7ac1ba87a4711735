#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "rayfield/core/result.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// How the memory that process() may take is shared out (docs/architecture.md, "Memory"). Shares are of what the
/// program itself leaves; stages that run one after the other have the same share in turn.
struct ProcessMemory {
  static constexpr std::uint64_t kProgram = std::uint64_t{96} << 20;  ///< code, libraries, what small things add up to
  /// A chunk of rays, what one tile's are counted in, and what the allocator keeps for a thread.
  static constexpr std::uint64_t kPerThread = std::uint64_t{48} << 20;

  std::size_t canopy_bytes;   ///< canopy maps of all tiles, while rows are looked for
  std::size_t surveys_bytes;  ///< low histograms of tiles that their neighbours will want, while the ground is made
  std::size_t counts_bytes;   ///< voxels of the tile that is being counted, one copy for each thread
  std::size_t tiles_bytes;    ///< counted tiles that the next rows will want
  std::size_t rows_bytes;     ///< rows of which densities are being estimated
  std::size_t maps_bytes;     ///< the part of the block's maps that is being added to
  int threads;                ///< as asked for, and as many as have room for their rays

  explicit ProcessMemory(const ProcessOptions& options);
};

/// Errors: resources, when `share` has no room for `bytes`; it says what --memory would do. `where`: the scan, and the
/// row or tile; `what`: what takes the memory, with its verb.
Result<void> check_room(std::size_t share, std::size_t bytes, const ProcessOptions& options, const std::string& where,
                        const std::string& what);
/// How many things of `bytes` each may be in hand at a time, up to `threads`. Errors: as check_room(), for one of them.
Result<int> workers_within(std::size_t share, std::size_t bytes, int threads, const ProcessOptions& options,
                           const std::string& where);

}  // namespace rayfield::density
