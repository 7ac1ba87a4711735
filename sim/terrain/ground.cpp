#include "sim/terrain/ground.h"

namespace rayfield::sim {

Eigen::Vector3d Ground::row_point(int row, double chainage, double offset, double height) const {
  const Eigen::Vector2d center = block.row_point(row, chainage);
  const Eigen::Vector2d along = block.row_direction(row, chainage);
  const Eigen::Vector2d p = center + offset * Eigen::Vector2d(along.y(), -along.x());
  return {p.x(), p.y(), terrain.smooth_height(center) + height};
}

}  // namespace rayfield::sim
