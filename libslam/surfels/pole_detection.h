#pragma once

#include <Eigen/Core>
#include <vector>

#include "libslam/surfels/surfel.h"
#include "libslam/surfels/voxel_map.h"
#include "libslam/trajectory/pose_track.h"
#include "rayfield/slam/options.h"

namespace rayfield::slam {

/// Detections of posts and trunks in a grid of voxels of one time bin: voxels whose points form a slim upright shape,
/// with hardly any points around it at its height. A detection is a surfel: `center` is the mean of the points,
/// `normal` points from there to the sensor, horizontally. `origin`: what the cells' sums refer to. `sensor`: in the
/// IMU frame, m.
std::vector<Surfel> detect_poles(const VoxelMap& map, double voxel_size_m, const Eigen::Vector3d& origin,
                                 const Eigen::Vector3d& sensor, const PoseTrack& track, const PoleOptions& options);

}  // namespace rayfield::slam
