#pragma once

#include <Eigen/Core>
#include <vector>

#include "libslam/surfels/cell_map.h"
#include "libslam/surfels/surfel.h"
#include "libslam/trajectory/pose_track.h"
#include "rayfield/slam/options.h"

namespace rayfield::slam {

/// Sightings of posts and trunks in a grid of voxels of one time bin: voxels whose points are a slim upright thing,
/// with hardly anything around it at its height. A sighting is a surfel: `center` is the mean of the points, `normal`
/// points from there to the sensor, horizontally. `origin`: what the cells' sums refer to. `sensor`: in the IMU frame,
/// m.
std::vector<Surfel> find_poles(const CellMap& map, double voxel_size_m, const Eigen::Vector3d& origin,
                               const Eigen::Vector3d& sensor, const PoseTrack& track, const PoleOptions& options);

}  // namespace rayfield::slam
