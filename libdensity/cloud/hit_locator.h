#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "libdensity/cloud/voxel_densities.h"
#include "libdensity/voxels/voxel_index.h"
#include "libdensity/voxels/wood.h"
#include "rayfield/core/density_points.h"

namespace rayfield::density {

/// Finds the voxels of one tile's hits. Safe for several threads, each with a mask of its own.
class HitLocator {
 public:
  /// `segments`: that touch the tile, with their densities in `values`; `wood`: likewise.
  struct Scene {
    std::vector<SegmentDensities> segments;
    std::vector<std::vector<float>> values;  ///< of each row segment, SegmentDensities::stored_shape()
    std::vector<WoodCylinder> wood;
    double wood_shell_m = 0;
  };
  HitLocator(Scene scene, const tile::TileRef& tile);

  using Mask = std::vector<std::uint64_t>;
  Mask mask() const { return Mask(static_cast<std::size_t>(index_.words())); }

  struct Found {
    PointKind kind = PointKind::canopy;
    float density = 0;  ///< m²/m³; NaN on wood and where it is not known
  };
  /// Nothing where no voxel holds the point. Where row segments overlap (at bends of a row) the first one counts.
  std::optional<Found> find(const Eigen::Vector3d& p_in_map, Mask& mask) const;

 private:
  Scene scene_;
  std::vector<GridFrame> frames_;
  VoxelIndex index_;
};

}  // namespace rayfield::density
