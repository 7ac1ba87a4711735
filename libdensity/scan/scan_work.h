#pragma once

#include <string>

#include "libdensity/scan/process_memory.h"
#include "libdensity/tiles/derive.h"
#include "rayfield/core/progress.h"
#include "rayfield/density/options.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// scan: the stages of one scan up to its voxels. The store keeps the result of each under a key of all it depends on.
/// What they share:
struct ScanWork {
  const tile::Store& store;
  const tile::ScanEntry& scan;
  const ProcessOptions& options;
  Derivation& files;
  Progress& progress;
  ProcessMemory memory = ProcessMemory(options);
  int threads = memory.threads;
  VoxelOptions voxels = {};     ///< the options', or for a scan with all its rays: count all
  std::string layout_key = {};  ///< names the layout in the keys of what depends on it

  double tile_size_m() const { return store.config().tile_size_m; }
  tile::TileRef tile_of(const tile::TileEntry& entry) const { return {entry.index, tile_size_m()}; }
};

}  // namespace rayfield::density
