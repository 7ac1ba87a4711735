#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libdensity/estimate/row_density.h"
#include "libdensity/scan/scan_work.h"
#include "libdensity/tiles/recently_used.h"
#include "libdensity/voxels/row_segments.h"
#include "libdensity/voxels/wood.h"

namespace rayfield::density {

/// How many rows may be estimated at a time. `wide`: of beams that are not thin. Errors: resources, when the longest
/// has no room.
Result<int> rows_in_hand(const ScanWork& work, const RowSegmentList& list, bool wide);
/// The same within the memory and threads of the options, outside of process().
Result<int> rows_in_hand(const ProcessOptions& options, const std::string& scan_id, const RowSegmentList& list,
                         bool wide);

/// Reads counters by their name.
using ReadVoxels = std::function<Result<tile::ArraySet>(const std::string& name)>;

/// The counters of a scan's tiles (count_voxels()), brought together row by row. Tiles are read when needed;
/// neighbouring rows run through the same ones, so the latest are kept, as many as fit. density() is safe to call from
/// several threads.
class RowVoxels {
 public:
  /// `prefix`: of the counters' names. `bytes`: bounds what is kept.
  static Result<RowVoxels> open(ReadVoxels read, std::string prefix, std::span<const tile::TileIndex> tiles,
                                std::size_t bytes);
  /// Those that `work`, which has to outlive the result, has made or taken.
  static Result<RowVoxels> open(const ScanWork& work, std::string prefix, std::span<const tile::TileIndex> tiles,
                                std::size_t bytes);

  /// Neighbouring beams of all tiles.
  const LeafSizePairs& pairs() const { return pairs_; }
  bool has_row(int row) const { return tiles_of_row_.count(row) > 0; }
  /// A row without a counted voxel is unobserved throughout. `model`: see RowDensityBuilder.
  Result<RowDensity> density(int row, const RowSegmentList& list, std::span<const WoodCylinder> wood,
                             const EstimatorOptions& options, const std::optional<EchoModel>& model);

 private:
  RowVoxels(ReadVoxels read, std::string prefix, std::size_t bytes)
      : read_(std::move(read)), prefix_(std::move(prefix)), tiles_(std::make_unique<Tiles>(bytes)) {}
  Result<std::shared_ptr<const TileVoxels>> get(tile::TileIndex index);

  using Tiles = RecentlyUsed<tile::TileIndex, TileVoxels>;
  ReadVoxels read_;
  std::string prefix_;
  std::unique_ptr<Tiles> tiles_;
  LeafSizePairs pairs_;
  std::map<int, std::vector<tile::TileIndex>> tiles_of_row_;
};

}  // namespace rayfield::density
