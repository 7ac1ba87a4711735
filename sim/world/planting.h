#pragma once

#include <vector>

#include "rayfield/sim/terrain.h"
#include "rayfield/sim/world.h"
#include "sim/world/triangle_mesh.h"

/// The parts of a vineyard. Each function appends the triangles of one row or of the whole surroundings; all are pure
/// functions of the site, its seed and the date's leaf fraction.
namespace rayfield::sim {

/// What the parts are built on.
struct Ground {
  const Site& site;
  const BlockGeometry& block;
  const Terrain& terrain;

  /// The point at `chainage` on a row, `offset` m to the right and `height` m over the trellis' foot line.
  Eigen::Vector3d row_point(int row, double chainage, double offset, double height) const;
};

/// All vines of the block with their vigour and full leaf area.
std::vector<Vine> plan_vines(const Site& site);
/// Chainages of a row's posts, from end to end.
std::vector<double> post_chainages(const RowOptions& rows);

void add_posts(const Ground& ground, int row, std::vector<Post>& posts, TriangleMesh& mesh);
void add_wires(const Ground& ground, int row, TriangleMesh& mesh);
/// Trunk, cordon and canes of one vine; `vine_id` numbers the vines of the block.
void add_vine_wood(const Ground& ground, const Vine& vine, std::uint64_t vine_id, TriangleMesh& mesh);
/// The leaves of one vine that are present at `leaf_fraction`; answers how many.
std::uint64_t add_vine_leaves(const Ground& ground, const Vine& vine, std::uint64_t vine_id, double leaf_fraction,
                              const class LeafNormals& normals, TriangleMesh& mesh);

void add_grass(const Ground& ground, TriangleMesh& mesh);
struct SurroundingMeshes {
  TriangleMesh leaves, wood, buildings;
};
void add_surroundings(const Ground& ground, SurroundingMeshes& meshes);

}  // namespace rayfield::sim
