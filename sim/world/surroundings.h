#pragma once

#include "sim/terrain/ground.h"
#include "sim/terrain/triangle_mesh.h"

namespace rayfield::sim {

void add_grass(const Ground& ground, TriangleMesh& mesh);

/// Trees, buildings and the fence around the block, by material.
struct SurroundingMeshes {
  TriangleMesh leaves, wood, buildings;
};
void add_surroundings(const Ground& ground, SurroundingMeshes& meshes);

}  // namespace rayfield::sim
