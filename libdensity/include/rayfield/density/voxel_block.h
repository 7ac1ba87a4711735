#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rayfield/core/lidar_beam.h"
#include "rayfield/core/ray.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// Cubic voxels in a level box with its sides along x, y and z; voxel (along, across, up) has index
/// (along·n_across + across)·n_up + up. `along` stands for the direction of a row: slabs lie along it and upwards.
struct VoxelBlock {
  Eigen::Vector3d low_m = Eigen::Vector3d::Zero();  ///< corner with the least coordinates, in the frame of the rays
  int n_along = 1, n_across = 1, n_up = 1;          ///< voxels along x, y and z
  double voxel_m = 0.08;                            ///< side
};

struct VoxelBlockOptions {
  VoxelOptions voxels;
  EstimatorOptions estimator;
  BeamOptions beam;
};

/// What the echoes of wide beams were taken for (docs/beams.md).
struct BlockEchoes {
  double full_echo = 0;        ///< mean intensity of the echo of leaves that take the whole beam
  double detection_share = 0;  ///< weakest echo, in full ones
  double leaf_size_m2 = 0;     ///< of one leaf
};

struct VoxelBlockDensity {
  std::vector<float> density_m2_m3;   ///< one-sided area per volume of each voxel; 0 where it is not known
  double area_m2 = 0;                 ///< one-sided, of all leaves in the block
  double leaf_size_m2 = 0;            ///< of one leaf, as used
  std::optional<BlockEchoes> echoes;  ///< absent: thin beams, or too few echoes to correct, which count as hits
};

/// The density of leaves in a block from the rays that cross it, counted and estimated as process() does in the row
/// segments of a scan, but without a store, ground, posts or trunks. `rays`: in the order of the scan, since
/// neighbouring ones tell the size of the leaves; `beam`: absent or without a width for thin rays. Errors: usage
/// (options, a block without voxels).
Result<VoxelBlockDensity> estimate_voxel_block(const VoxelBlock& block, const RayBatch& rays,
                                               const std::optional<LidarBeam>& beam, const VoxelBlockOptions& options);

}  // namespace rayfield::density
