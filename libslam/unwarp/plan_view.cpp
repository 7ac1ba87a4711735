#include "rayfield/slam/plan_view.h"

#include <algorithm>
#include <cmath>

namespace rayfield::slam {

Grid2<std::uint32_t> plan_grid(const Trajectory& trajectory, double reach_m, double cell_m) {
  if (trajectory.empty()) return {};
  Eigen::Vector2d low = trajectory.poses.front().map_from_body.translation.head<2>(), high = low;
  for (const TimedPose& p : trajectory.poses) {
    low = low.cwiseMin(p.map_from_body.translation.head<2>());
    high = high.cwiseMax(p.map_from_body.translation.head<2>());
  }
  low.array() -= reach_m, high.array() += reach_m;
  const double cell = std::max(cell_m, (high - low).maxCoeff() / 4000);
  return {low, cell, std::max(1, static_cast<int>((high.x() - low.x()) / cell)),
          std::max(1, static_cast<int>((high.y() - low.y()) / cell)), 0u};
}

void add_hits(Grid2<std::uint32_t>& grid, const RayBatch& rays) {
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (rays.hit[k] == 0) continue;
    const Eigen::Vector2d c = (rays.end[k].head<2>() - grid.origin) / grid.cell_m;
    const int ix = static_cast<int>(std::floor(c.x())), iy = static_cast<int>(std::floor(c.y()));
    if (grid.contains(ix, iy)) ++grid.at(ix, iy);
  }
}

}  // namespace rayfield::slam
