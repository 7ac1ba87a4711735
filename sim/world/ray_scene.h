#pragma once

/// world: a block on one date with its surroundings, ready for rays, and its place on the map.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/sim/world.h"
#include "sim/terrain/triangle_mesh.h"

namespace rayfield::sim {

/// Triangles ready for ray casting (Embree; nothing of it shows outside the source file). Casting is const and may run
/// from any number of threads; the nearest hit does not depend on them.
class RayScene {
 public:
  static Result<RayScene> create();
  /// Copies the mesh into the scene. Empty meshes are fine. Not after commit().
  Result<void> add(const TriangleMesh& mesh, Material material);
  /// The same for a mesh that moves: its vertices at times spread evenly over 0 … 1, in between on straight lines.
  Result<void> add_moving(const TriangleMesh& mesh, std::span<const std::vector<Eigen::Vector3f>> vertices,
                          Material material);
  /// Builds the search tree.
  Result<void> commit();
  /// The nearest hit of the ray from `origin` along the unit vector `direction` up to `max_range_m`, at a time 0 … 1.
  std::optional<SceneHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m,
                               double time = 0) const;
  /// The same for rays that lie close together, a packet at a time. A hit per ray; infinite ranges: nothing was met.
  void cast(std::span<const SceneRay> rays, double max_range_m, double time, std::span<SceneHit> hits) const;
  std::size_t triangle_count() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace rayfield::sim
