#pragma once

#include <span>
#include <vector>

#include "libdensity/scan/scan_work.h"
#include "libdensity/voxels/wood.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// What, beside its counters, row segments and echoes, the densities of a scan were estimated with: whoever wants them
/// again voxel by voxel need not know the options of the run that made them.
struct Estimation {
  EstimatorOptions estimator;
  double wood_shell_m = 0;         ///< VoxelOptions::wood_shell_m
  std::vector<WoodCylinder> wood;  ///< that was masked
};

/// Keeps it among the scan's files (kind "estimation").
Result<void> keep_estimation(ScanWork& work, std::span<const WoodCylinder> wood);

/// Of a scan that was processed. Errors: usage (not processed, or by a version that did not keep it), damaged.
Result<Estimation> read_estimation(const tile::Store& store, const tile::ScanEntry& scan);

}  // namespace rayfield::density
