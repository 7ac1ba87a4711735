#include "libdensity/pipeline/scan_maps.h"

#include <cmath>
#include <limits>

#include "libdensity/integration/raster_frame.h"
#include "libdensity/layout/polyline.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {

Result<void> mark_lanes(const RowLayout& layout, const ScanSurvey& survey, double tile_size_m, double cell_m,
                        PlanRaster& plan) {
  const auto scanned = [&](const Eigen::Vector2d& p) {
    const tile::TileIndex index{floor_int(p.x() / tile_size_m), floor_int(p.y() / tile_size_m)};
    const auto found = survey.coverage().find(index);
    if (found == survey.coverage().end()) return false;
    const Grid2<std::uint8_t>& coverage = found->second;
    const Eigen::Vector2d c = (p - coverage.origin) / coverage.cell_m;
    const int ix = floor_int(c.x()), iy = floor_int(c.y());
    return coverage.contains(ix, iy) && (coverage.at(ix, iy) & kCoverageHit) != 0;
  };
  const double reach = std::isfinite(layout.spacing_m) ? layout.spacing_m / 2 : 1.0;
  const double step = cell_m / 2;
  for (const Row& row : layout.rows) {
    const double length = row.length_m();
    double along = 0;
    while (along <= length) {
      const LinePoint point = point_at(row.centreline, along);
      double across = -reach;
      while (across <= reach) {
        const Eigen::Vector2d p = point.position + across * Eigen::Vector2d(-point.direction.y(), point.direction.x());
        if (scanned(p)) RAYFIELD_CHECK(plan.mark_scanned(p));
        across += step;
      }
      along += step;
    }
  }
  return {};
}

Result<GroundMap> ground_map(const GroundModel& ground, const RowLayout& layout) {
  double cell = 0.25;
  for (const auto& [index, nodes] : ground.tiles()) cell = nodes.cell_m;
  RAYFIELD_ASSIGN(const RasterFrame frame, ground_frame(layout, cell));
  GroundMap map{{"ground", "m", "Height of the ground", Grid2<float>(frame.origin, frame.cell_m, 0, 0)}, {}};
  map.raster.grid.nx = frame.nx, map.raster.grid.ny = frame.ny;
  map.values.count = static_cast<std::uint64_t>(frame.nx) * static_cast<std::uint64_t>(frame.ny);
  map.values.read = [&ground, grid = map.raster.grid](std::uint64_t first, std::span<float> values) -> Result<void> {
    const auto nx = static_cast<std::uint64_t>(grid.nx);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Eigen::Vector2d p = grid.center(static_cast<int>((first + i) % nx), static_cast<int>((first + i) / nx));
      const auto height = ground.height(p.x(), p.y());
      values[i] = height ? static_cast<float>(*height) : std::numeric_limits<float>::quiet_NaN();
    }
    return {};
  };
  return map;
}

}  // namespace rayfield::density
