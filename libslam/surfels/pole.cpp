#include "libslam/surfels/pole.h"

namespace rayfield::slam {
namespace {

// Points of the cells around one at its height.
int points_around(const CellMap& map, const Cell& cell) {
  int count = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      if (const Cell* other = map.find(cell.x + dx, cell.y + dy, cell.z)) count += other->count;
    }
  return count;
}

bool is_pole(const CellMap& map, const Cell& cell, double voxel_size_m, const PoleOptions& options) {
  if (cell.count < options.min_points) return false;
  const Eigen::Matrix3d covariance = cell.covariance();
  const double upright = options.min_upright_fraction * voxel_size_m;
  if (!(covariance(0, 0) + covariance(1, 1) < options.max_spread_m * options.max_spread_m)) return false;
  if (!(covariance(2, 2) > upright * upright)) return false;
  return points_around(map, cell) <= options.max_around * cell.count;
}

}  // namespace

std::vector<Surfel> find_poles(const CellMap& map, double voxel_size_m, const Eigen::Vector3d& origin,
                               const Eigen::Vector3d& sensor, const PoseTrack& track, const PoleOptions& options) {
  std::vector<Surfel> out;
  for (const Cell& cell : map.cells()) {
    if (!is_pole(map, cell, voxel_size_m, options)) continue;
    Surfel s;
    s.time_s = cell.time_sum / cell.count;
    const Rigid3 pose = track.pose(s.time_s);
    const Eigen::Vector3d center = cell.mean() + origin;
    Eigen::Vector3d back = pose * sensor - center;
    back.z() = 0;
    if (!(back.norm() < options.max_range_m)) continue;
    const Eigen::Quaterniond inverse = pose.rotation.conjugate();
    s.center = (inverse * (center - pose.translation)).cast<float>();
    s.normal = (inverse * back.normalized()).cast<float>();
    s.spin_rate_rad_s = static_cast<float>(cell.spin_sum / cell.count);
    out.push_back(s);
  }
  return out;
}

}  // namespace rayfield::slam
