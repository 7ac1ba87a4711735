#include "libslam/surfels/pole_detection.h"

namespace rayfield::slam {
namespace {

// Points of the voxels around one at its height.
int points_around(const VoxelMap& map, const VoxelSums& voxel) {
  int count = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      if (const VoxelSums* other = map.find(voxel.x + dx, voxel.y + dy, voxel.z)) count += other->count;
    }
  return count;
}

bool is_pole(const VoxelMap& map, const VoxelSums& voxel, double voxel_size_m, const PoleOptions& options) {
  if (voxel.count < options.min_points) return false;
  const Eigen::Matrix3d covariance = voxel.covariance();
  const double upright = options.min_upright_fraction * voxel_size_m;
  if (!(covariance(0, 0) + covariance(1, 1) < options.max_spread_m * options.max_spread_m)) return false;
  if (!(covariance(2, 2) > upright * upright)) return false;
  return points_around(map, voxel) <= options.max_around * voxel.count;
}

}  // namespace

std::vector<Surfel> detect_poles(const VoxelMap& map, double voxel_size_m, const Eigen::Vector3d& origin,
                                 const Eigen::Vector3d& sensor, const PoseTrack& track, const PoleOptions& options) {
  std::vector<Surfel> out;
  for (const VoxelSums& voxel : map.voxels()) {
    if (!is_pole(map, voxel, voxel_size_m, options)) continue;
    Surfel s;
    s.time_s = voxel.time_sum / voxel.count;
    const Rigid3 pose = track.pose(s.time_s);
    const Eigen::Vector3d center = voxel.mean() + origin;
    Eigen::Vector3d back = pose * sensor - center;
    back.z() = 0;
    if (!(back.norm() < options.max_range_m)) continue;
    const Eigen::Quaterniond inverse = pose.rotation.conjugate();
    s.center = (inverse * (center - pose.translation)).cast<float>();
    s.normal = (inverse * back.normalized()).cast<float>();
    s.spin_rate_rad_s = static_cast<float>(voxel.spin_sum / voxel.count);
    out.push_back(s);
  }
  return out;
}

}  // namespace rayfield::slam
