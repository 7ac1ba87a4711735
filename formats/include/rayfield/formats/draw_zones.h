#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "rayfield/core/grid2.h"
#include "rayfield/core/result.h"
#include "rayfield/core/zone_products.h"

/// Management zones of a block as polygons (docs/farm-systems.md, "Management zones").
namespace rayfield::formats {

/// Draws zones between the contours of a surface. The zones cover the union of `bands` (closed rings, gaps of up to
/// half their width filled), share their borders and do not overlap: contours and outline are cut at their crossings
/// and made into faces (GEOS), each of which takes the class of the surface inside it. Parts smaller than `min_zone_m2`
/// join the neighbour with which they share the longest border. Classes of which no part is left have no
/// zone. Contours are simplified by at most a fifth of a cell. Errors: bad_input (no band), internal.
Result<std::vector<ManagementZone>> draw_zones(const Grid2<double>& surface, std::span<const double> breaks,
                                               std::span<const std::vector<Eigen::Vector2d>> bands, double min_zone_m2);

}  // namespace rayfield::formats
