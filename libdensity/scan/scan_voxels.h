#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libdensity/scan/scan_work.h"
#include "libdensity/voxels/beam_view.h"
#include "libdensity/voxels/row_segments.h"
#include "libdensity/voxels/voxel_accumulator.h"
#include "libdensity/voxels/wood.h"

namespace rayfield::density {

/// What can be met in one tile.
struct TileScene {
  std::vector<RowSegment> row_segments;
  std::vector<WoodCylinder> wood;
};
TileScene scene_of(const tile::TileRef& tile, double margin_m, const RowSegmentList& list,
                   std::span<const WoodCylinder> wood);

/// In how many copies of `empty` the rays of a tile may be counted at a time. Errors: resources, when one has no room.
Result<int> counting_workers(const ScanWork& work, tile::TileIndex tile, const VoxelAccumulator& empty);

/// Calls visit(tile, its empty counters) for those of the tiles that have voxels of the row segments, and tells the
/// progress of each. Errors: of `visit`; interrupted.
Result<void> for_voxel_tiles(ScanWork& work, std::span<const tile::TileEntry> tiles, const RowSegmentList& row_segments,
                             std::span<const WoodCylinder> wood, const std::shared_ptr<const BeamView>& view,
                             const std::function<Result<void>(const tile::TileEntry&, VoxelAccumulator)>& visit);

/// Rays to count in the voxels of a scan: its own, or those of the dormant scan that shows its wood.
struct CountedRays {
  const tile::ScanEntry& scan;
  VoxelOptions voxels;
  std::string prefix;                              ///< of the counters' names: "", or "wood_"
  std::shared_ptr<const BeamView> view = nullptr;  ///< of beams that are not thin
  bool pairs = true;                               ///< TileVoxels::pairs, too: where they tell the leaves' size
};

/// Counts rays in the voxels of every tile that a row segment touches; the counters stay in the store (kind "voxels",
/// name: prefix and tile). Returns the tiles that have any, in order.
Result<std::vector<tile::TileIndex>> count_voxels(ScanWork& work, const CountedRays& rays,
                                                  const RowSegmentList& row_segments,
                                                  std::span<const WoodCylinder> wood);

}  // namespace rayfield::density
