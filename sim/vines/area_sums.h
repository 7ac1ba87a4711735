#pragma once

#include <vector>

#include "rayfield/sim/vineyard.h"
#include "sim/terrain/terrain.h"
#include "sim/terrain/triangle_mesh.h"

namespace rayfield::sim {

/// Lowest height over the local ground at which wood counts, m (the bottom of the density voxels).
inline constexpr double kWoodFromHeight = 0.3;
/// Length of an interval of RowAreas::metres, m.
inline constexpr double kMetreStep = 0.5;

/// Adds up the areas of triangles by their place along the row. Triangles that straddle an edge are cut there, so that
/// every interval gets exactly what lies in it; what lies beyond a row end counts for its last interval.
class AreaSums {
 public:
  AreaSums(const Site& site, const BlockGeometry& block, const Terrain& terrain);
  /// One-sided area of leaves: triangles [first, last) of `mesh`.
  void add_leaves(int row, const TriangleMesh& mesh, std::size_t first, std::size_t last);
  /// Half the area of closed surfaces, where higher than kWoodFromHeight over the ground.
  void add_wood(int row, const TriangleMesh& mesh, std::size_t first, std::size_t last);
  const std::vector<RowAreas>& rows() const { return rows_; }

 private:
  const BlockGeometry& block_;
  const Terrain& terrain_;
  std::vector<RowAreas> rows_;
};

}  // namespace rayfield::sim
