#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "rayfield/sim/site.h"
#include "sim/terrain/triangle_mesh.h"

namespace rayfield::sim {

/// Adds a flat leaf with the given one-sided area and its centre of gravity at `center`; both axes are unit and
/// orthogonal. The longer diagonal of a rhombus (1.05 of the square root of twice the area), a corner of a triangle and
/// the tip of a lobe point along `long_axis`.
void add_leaf(TriangleMesh& mesh, LeafShape shape, const Eigen::Vector3d& center, const Eigen::Vector3d& long_axis,
              const Eigen::Vector3d& short_axis, double leaf_size_m2);

/// Vertices that add_leaf() adds for a leaf.
std::size_t vertices_of(LeafShape shape);

}  // namespace rayfield::sim
