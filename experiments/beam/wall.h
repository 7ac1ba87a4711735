#pragma once

#include <vector>

#include "rayfield/density/voxel_block.h"
#include "rayfield/experiments/beam.h"
#include "rayfield/sim/leaf_box.h"

/// beam: a wall of leaves, and a lidar that goes past it.
namespace rayfield::experiments {

/// The wall of one trial: leaves of one size in a box along x, the pulses of a drive past it, and the voxels round it.
struct Wall {
  sim::LeafBox leaves;
  std::vector<sim::Pulse> pulses;
  density::VoxelBlock block;
};
Result<Wall> build_wall(const BeamExperimentOptions& options, double density_m2_m3, double leaf_size_m2,
                        std::uint64_t seed);

/// Side of voxels that `process` fits to leaves of that size.
double fitted_voxel_m(double leaf_size_m2);

}  // namespace rayfield::experiments
