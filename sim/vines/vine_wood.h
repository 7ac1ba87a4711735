#pragma once

#include <cstddef>
#include <cstdint>

#include "rayfield/sim/vineyard.h"
#include "sim/terrain/ground.h"
#include "sim/terrain/triangle_mesh.h"

namespace rayfield::sim {

/// Trunk, cordon and canes of one vine; `vine_id` numbers the vines of the block. Returns how many triangles are the
/// trunk's, which come first.
std::size_t add_vine_wood(const Ground& ground, const Vine& vine, std::uint64_t vine_id, TriangleMesh& mesh);

}  // namespace rayfield::sim
