#pragma once

/// vines: trellis, wood and leaves of the rows as triangles, how the wind moves them, and the areas they add up to.

#include <cstdint>
#include <vector>

#include "rayfield/sim/vineyard.h"
#include "sim/terrain/ground.h"
#include "sim/terrain/triangle_mesh.h"
#include "sim/vines/leaf_angles.h"

namespace rayfield::sim {

/// All vines of the block with their vigour and full leaf area.
std::vector<Vine> plan_vines(const Site& site);
/// The leaves of one vine that are present at `leaf_fraction`; answers how many.
std::uint64_t add_vine_leaves(const Ground& ground, const Vine& vine, std::uint64_t vine_id, double leaf_fraction,
                              const LeafNormals& normals, TriangleMesh& mesh);

}  // namespace rayfield::sim
