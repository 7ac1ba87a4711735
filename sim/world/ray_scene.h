#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "rayfield/core/result.h"
#include "rayfield/sim/world.h"
#include "sim/world/triangle_mesh.h"

namespace rayfield::sim {

/// Triangles ready for ray casting (Embree; nothing of it shows outside the source file). Casting is const and may run
/// from any number of threads; the nearest hit does not depend on them.
class RayScene {
 public:
  static Result<RayScene> create();
  /// Copies the mesh into the scene. Empty meshes are fine. Not after commit().
  Result<void> add(const TriangleMesh& mesh, Material material);
  /// Builds the search tree.
  Result<void> commit();
  /// The nearest hit of the ray from `origin` along the unit vector `direction` up to `max_range_m`.
  std::optional<SceneHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                               double max_range_m) const;
  std::size_t triangle_count() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace rayfield::sim
