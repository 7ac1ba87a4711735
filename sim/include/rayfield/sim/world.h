#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/sim/site.h"
#include "rayfield/sim/vineyard.h"

namespace rayfield::sim {

class BlockGeometry;
class Terrain;

enum class Material : std::uint8_t { ground, grass, leaf, wood, post, wire, building };

/// Where a ray met a surface first.
struct SceneHit {
  double range_m = 0;
  Material material = Material::ground;
  double cos_incidence = 0;  ///< |cos| of the angle between ray and surface normal
};

/// A ray in ENU; the direction is a unit vector.
struct SceneRay {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::UnitX();
};

/// A block on one date, ready for ray casting. Copies share the scene.
class World {
 public:
  const Site& site() const;
  const SiteDate& date() const;
  std::size_t date_index() const;
  const BlockGeometry& block() const;
  const Terrain& terrain() const;
  const std::vector<Vine>& vines() const;
  const std::vector<Post>& posts() const;
  const std::vector<RowAreas>& areas() const;    ///< one per row
  const std::vector<RowCanopy>& canopy() const;  ///< one per row
  std::uint64_t leaf_count() const;              ///< leaves present
  std::uint64_t triangle_count() const;

  /// The nearest surface from `origin` (ENU, m) along the unit vector `direction`, `time_s` after the start of the
  /// drive: leaves move with the wind. Safe from any thread.
  std::optional<SceneHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m,
                               double time_s = 0) const;
  /// The same for rays that lie close together, which is faster: one hit per ray, its range infinite where nothing was
  /// met.
  void cast(std::span<const SceneRay> rays, double max_range_m, double time_s, std::span<SceneHit> hits) const;

 private:
  friend Result<World> build_world(const Site&, std::size_t, int, Progress&);
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// Builds the block as it stands on site.dates[date_index]. The geometry is a function of the site and its seed; dates
/// choose among the leaves and nothing else. `threads` 0: all processors; the result does not depend on it.
/// Errors: usage (invalid site, no such date), resources (memory), interrupted.
Result<World> build_world(const Site& site, std::size_t date_index, int threads, Progress& progress);

}  // namespace rayfield::sim
