#include "libdensity/scan/row_voxels.h"

#include <algorithm>
#include <utility>

#include "libdensity/voxels/voxel_arrays.h"

namespace rayfield::density {
namespace {

std::size_t bytes_of(const TileVoxels& voxels) { return counter_bytes(voxels.row_segments); }

}  // namespace

Result<int> rows_in_hand(const ProcessOptions& options, const std::string& scan_id, const RowSegmentList& list,
                         bool wide) {
  std::map<int, Shape3> shapes;  // of the rows' grids, no smaller than they are
  for (const RowSegment& s : list.row_segments) {
    Shape3& shape = shapes[s.row];
    shape.ni += s.n_along, shape.nj = std::max(shape.nj, s.n_across), shape.nk = std::max(shape.nk, s.n_up);
  }
  std::size_t most = 0;
  int largest = 0;
  for (const auto& [row, shape] : shapes)
    if (const std::size_t bytes = RowDensityBuilder::peak_bytes(shape, wide); bytes > most) most = bytes, largest = row;
  const ProcessMemory memory(options);
  return workers_within(memory.rows_bytes, most, memory.threads, options, scan_id + ", row " + std::to_string(largest));
}

Result<int> rows_in_hand(const ScanWork& work, const RowSegmentList& list, bool wide) {
  return rows_in_hand(work.options, work.scan.scan_id, list, wide);
}

Result<RowVoxels> RowVoxels::open(const ScanWork& work, std::string prefix, std::span<const tile::TileIndex> tiles,
                                  std::size_t bytes) {
  return open([&work](const std::string& name) { return work.files.read("voxels", name); }, std::move(prefix), tiles,
              bytes);
}

Result<RowVoxels> RowVoxels::open(ReadVoxels read, std::string prefix, std::span<const tile::TileIndex> tiles,
                                  std::size_t bytes) {
  RowVoxels rows(std::move(read), std::move(prefix), bytes);
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
  const auto load = [&]() -> Result<TileVoxels> {
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, read_(prefix_ + tile_name(index)));
    return voxels_from_arrays(arrays);
  };
  return tiles_->get(index, load, bytes_of);
}

}  // namespace rayfield::density
