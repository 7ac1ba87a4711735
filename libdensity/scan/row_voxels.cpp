#include "libdensity/scan/row_voxels.h"

#include <utility>

#include "libdensity/voxels/voxel_arrays.h"

namespace rayfield::density {

Result<RowVoxels> RowVoxels::open(ScanWork& work, std::string prefix, std::span<const tile::TileIndex> tiles,
                                  std::size_t bytes) {
  RowVoxels rows(work, std::move(prefix), bytes);
  for (const tile::TileIndex index : tiles) {
    RAYFIELD_ASSIGN(const auto voxels, rows.get(index));
    rows.pairs_ += voxels->pairs;
    for (const RowSegmentVoxels& row_segment : voxels->row_segments) {
      std::vector<tile::TileIndex>& of_row = rows.tiles_of_row_[row_segment.row_segment.row];
      if (of_row.empty() || of_row.back() != index) of_row.push_back(index);
    }
  }
  return rows;
}

Result<RowDensity> RowVoxels::density(int row, const RowSegmentList& list, std::span<const WoodCylinder> wood,
                                      const EstimatorOptions& options, const std::optional<EchoModel>& model) {
  RAYFIELD_ASSIGN(RowDensityBuilder builder,
                  RowDensityBuilder::create(row, list.row_segments, wood, pairs_, options, model));
  if (const auto tiles = tiles_of_row_.find(row); tiles != tiles_of_row_.end()) {
    for (const tile::TileIndex index : tiles->second) {
      RAYFIELD_ASSIGN(const auto voxels, get(index));
      RAYFIELD_CHECK(builder.add(*voxels));
    }
  }
  return std::move(builder).finish();
}

Result<std::shared_ptr<const TileVoxels>> RowVoxels::get(tile::TileIndex index) {
  for (auto it = kept_.begin(); it != kept_.end(); ++it) {
    if (it->voxels->tile != index) continue;
    kept_.splice(kept_.begin(), kept_, it);
    return kept_.front().voxels;
  }
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work_->files.read("voxels", prefix_ + tile_name(index)));
  RAYFIELD_ASSIGN(TileVoxels voxels, voxels_from_arrays(arrays));
  std::size_t size = 0;
  for (const RowSegmentVoxels& row_segment : voxels.row_segments)
    size += row_segment.voxels.size() * sizeof(VoxelCounters) + row_segment.echoes.size() * sizeof(EchoCounters);
  kept_.push_front({std::make_shared<const TileVoxels>(std::move(voxels)), size});
  used_ += size;
  while (used_ > bytes_ && kept_.size() > 1) {
    used_ -= kept_.back().bytes;
    kept_.pop_back();
  }
  return kept_.front().voxels;
}

}  // namespace rayfield::density
