#pragma once

/// terrain: where rows and lanes lie, the bare ground under them, and the triangles that all is made of.

#include <Eigen/Core>

#include "rayfield/sim/site.h"
#include "sim/terrain/block_geometry.h"
#include "sim/terrain/terrain.h"

namespace rayfield::sim {

/// What the parts of a vineyard are built on (trellis.h, canopy.h, vine_wood.h, surroundings.h). Their functions append
/// the triangles of one row or of the whole surroundings; all are pure functions of the site, its seed and the date's
/// leaf fraction.
struct Ground {
  const Site& site;
  const BlockGeometry& block;
  const Terrain& terrain;

  /// The point at `chainage` on a row, `offset` m to the right and `height` m over the smooth ground under the row.
  Eigen::Vector3d row_point(int row, double chainage, double offset, double height) const;
};

}  // namespace rayfield::sim
