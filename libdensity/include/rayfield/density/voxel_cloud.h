#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "rayfield/core/density_points.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

struct VoxelCloudOptions {
  int threads = 0;                                      ///< 0 = all processors
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< bound on resident memory, as of process()
  std::filesystem::path scratch_folder;                 ///< of a temporary file without a name, 4 B per voxel
};

/// The hits of a processed scan with the densities of their voxels. Densities are estimated anew from the stored
/// counters, by the code that made the panels and maps of them, and kept in a temporary file: memory is bounded by the
/// options, not by rays or rows. Results are the same at any number of threads.
class VoxelCloud {
 public:
  /// Estimates the densities of all rows. `store` and `scan` have to outlive the result. Errors: usage (not processed),
  /// damaged, resources (also where the bound has no room for the longest row), interrupted.
  static Result<VoxelCloud> open(const tile::Store& store, const tile::ScanEntry& scan,
                                 const VoxelCloudOptions& options, Progress& progress);

  /// One-sided area of everything in the rows' voxels, and without masked wood, m².
  double plant_area_m2() const;
  double canopy_area_m2() const;

  /// Densities of the voxels, m²/m³, row by row; NaN where they are not known.
  Result<void> for_voxels(const std::function<void(std::span<const float> densities)>& take) const;

  /// Passes on every hit in the rows' voxels exactly once, by tiles and within a tile in the order of the scan; the
  /// batches are no longer than a chunk of a tile. Hits outside of all voxels (ground, lanes, what stands beside the
  /// rows) are left out. Errors: those of `take`; damaged, interrupted.
  Result<void> for_hits(Progress& progress, const std::function<Result<void>(const DensityPoints& points)>& take) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace rayfield::density
