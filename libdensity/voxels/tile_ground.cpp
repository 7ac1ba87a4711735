#include "libdensity/voxels/tile_ground.h"

#include <Eigen/Dense>

namespace rayfield::density {

TileGround TileGround::of(std::span<const RowSegment> row_segments) {
  // Two metres to either side bring in the slope across the row where the tile holds one row only.
  constexpr double kAside = 2.0;
  TileGround out;
  if (row_segments.empty()) return out;
  std::vector<Eigen::Vector3d> points;
  for (const RowSegment& s : row_segments) {
    const Eigen::Vector2d v(-s.direction.y(), s.direction.x());
    for (const double along : {0.0, s.n_along * s.voxel_m})
      for (const double across : {-kAside, kAside}) {
        const Eigen::Vector2d p = s.origin + along * s.direction + across * v;
        points.emplace_back(p.x(), p.y(), s.ground_m + s.slope_along * along + s.slope_across * across);
      }
  }
  for (const Eigen::Vector3d& p : points) out.center += p / static_cast<double>(points.size());
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d q = p - out.center;
    normal += q.head<2>() * q.head<2>().transpose();
    right += q.z() * q.head<2>();
  }
  out.slope = normal.ldlt().solve(right);
  if (!out.slope.allFinite()) out.slope.setZero();
  return out;
}

}  // namespace rayfield::density
