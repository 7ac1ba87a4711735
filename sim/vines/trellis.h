#pragma once

#include <vector>

#include "rayfield/sim/vineyard.h"
#include "sim/terrain/ground.h"
#include "sim/terrain/triangle_mesh.h"

namespace rayfield::sim {

/// Chainages of a row's posts, from end to end.
std::vector<double> post_chainages(const SiteRows& rows);

void add_posts(const Ground& ground, int row, std::vector<Post>& posts, TriangleMesh& mesh);
void add_wires(const Ground& ground, int row, TriangleMesh& mesh);

}  // namespace rayfield::sim
