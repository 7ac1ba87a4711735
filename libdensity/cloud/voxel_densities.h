#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "libdensity/estimate/row_density.h"
#include "rayfield/core/result.h"
#include "rayfield/core/spill_file.h"

/// cloud: every hit with the density of its voxel (docs/products.md, "Point cloud").
namespace rayfield::density {

/// Where the densities of a row segment's voxels are.
struct SegmentDensities {
  RowSegment row_segment;
  std::uint64_t first = 0;             ///< of its first value among those of all rows
  int n_across = 0, n_up = 0;          ///< of the row's grid, in which the row segment's lies
  int across_shift = 0, up_shift = 0;  ///< of the row segment's voxel (0, 0) in it
  Shape3 stored_shape() const { return {row_segment.n_along, n_across, n_up}; }
};

/// Densities of all voxels of a scan, in a temporary file without a name.
class VoxelDensities {
 public:
  explicit VoxelDensities(const std::filesystem::path& folder) : file_(std::make_unique<SpillFile>(folder)) {}

  /// Appends a row. Unobserved voxels become NaN. Errors: resources.
  Result<void> add(const RowDensity& row);

  /// Of all rows, in the order in which they were added.
  const std::vector<SegmentDensities>& segments() const { return segments_; }
  std::uint64_t count() const { return count_; }
  /// Fills `values` from the value with number `first` on.
  Result<void> read(std::uint64_t first, std::span<float> values) const;

  double plant_area_m2 = 0, canopy_area_m2 = 0;  ///< of the rows added so far

 private:
  std::unique_ptr<SpillFile> file_;
  std::vector<SegmentDensities> segments_;
  std::uint64_t count_ = 0;
};

}  // namespace rayfield::density
