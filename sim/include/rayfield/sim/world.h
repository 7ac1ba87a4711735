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

enum class PostKind { strainer, line };

/// A trellis post; rows, posts and panels count from 0 here as in the truth files.
struct Post {
  int row = 0, post = 0;
  double chainage_m = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< east, north
  double ground_m = 0;
  double height_m = 0;
  double diameter_m = 0;
  PostKind kind = PostKind::line;
};

struct Vine {
  int row = 0;
  double chainage_m = 0;
  bool missing = false;
  double vigour = 0;        ///< relative, mean about 1
  double leaf_area_m2 = 0;  ///< one-sided, with all leaves present
};

/// One-sided leaf area and half the surface of wood (posts, trunks, cordons, canes, wires above 0.3 m over the local
/// ground), m², in consecutive intervals of a row.
struct IntervalAreas {
  std::vector<double> edges_m;  ///< chainages, one more than there are intervals
  std::vector<double> leaf_m2, wood_m2;
};
struct RowAreas {
  IntervalAreas panels, metres;  ///< `metres`: every 0.5 m, the last shorter where the length wants it
};

/// The canopy of a stretch of row as an estimator should describe it, from the triangles themselves
/// (docs/simulation.md, "Canopy"). Canopy is leaves, canes, cordons and wires above 0.3 m over the ground, without
/// posts and trunks. Heights are over the ground under the row. NaN where there is no canopy.
struct CanopyTruth {
  double base_m = 0, height_m = 0, width_m = 0;  ///< lower and upper edge; across the row
  double row_gap_share = 0;
  double porosity = 0;             ///< share of lines across the row that meet nothing
  double leaf_layer_number = 0;    ///< leaves on a line, mean
  double canopy_layer_number = 0;  ///< leaves, canes, cordons and wires on a line, mean
  double exposed_leaf_share = 0;   ///< share of the leaves on lines that are the first or the last of theirs
};
/// Areas between two heights of a panel.
struct CanopyBand {
  double low_m = 0, high_m = 0, leaf_m2 = 0, wood_m2 = 0;
};
struct RowCanopy {
  std::vector<CanopyTruth> panels, metres;        ///< as RowAreas
  std::vector<std::vector<CanopyBand>> profiles;  ///< of each panel, from the ground up
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
