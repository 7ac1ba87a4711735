#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libdensity/layout/row_layout.h"
#include "libdensity/voxels/leaf_angle.h"
#include "libdensity/echoes/leaf_size.h"
#include "libdensity/voxels/wood.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"
#include "rayfield/tile/segments.h"

/// Here rows get their voxel grids, and rays, hits and path lengths are counted in them (docs/density.md).
namespace rayfield::density {

/// Sums over the rays that cross one voxel. With x the true length of a ray inside the voxel up to its hit or to where
/// it leaves, the *spherical-equivalent* path is u = 2·G(θ)·x / voxel size (for spherical leaf angles u = x / voxel
/// size). Sums are integers in units of 2⁻²⁵, so that they do not depend on the order of the rays; u < 3.6, so that
/// they cannot overflow before `rays` does, and that is checked (VoxelAccumulator::add).
struct VoxelCounters {
  std::uint32_t rays = 0;      ///< n: rays that enter; one that starts inside counts
  std::uint32_t hits = 0;      ///< m: hits inside, those on masked wood left out
  std::int64_t path = 0;       ///< Σ u
  std::int64_t hit_path = 0;   ///< Σ u over the hits
  std::int64_t potential = 0;  ///< Σ of the u that the rays would have had without their hits here
  static constexpr double kUnit = 1.0 / (1 << 25);
  /// The sums in voxel sides.
  double path_sides() const { return kUnit * static_cast<double>(path); }
  double hit_path_sides() const { return kUnit * static_cast<double>(hit_path); }
  double potential_sides() const { return kUnit * static_cast<double>(potential); }
  VoxelCounters& operator+=(const VoxelCounters& other);
  bool operator==(const VoxelCounters&) const = default;
};
static_assert(sizeof(VoxelCounters) == 32, "two to a cache line");

/// The voxels of one row segment whose columns belong to one tile: a column belongs to the tile that holds its centre.
struct RowSegmentVoxels {
  RowSegment row_segment;
  std::vector<std::int32_t> column;  ///< n_along·n_across, [along·n_across + across]: number of the column here, or -1
  std::vector<std::uint32_t> entries;  ///< per column here: rays that enter the row's grid there (through any face but
                                       ///< the ends of the row segment) or start there; each ray once
  std::vector<VoxelCounters> voxels;   ///< [column·n_up + up]

  std::size_t column_count() const { return entries.size(); }
  /// The column's voxels from below, or an empty span where another tile has them.
  std::span<const VoxelCounters> column_voxels(int along, int across) const;
};

/// What one tile of one scan knows of the voxels in it.
struct TileVoxels {
  tile::TileIndex tile;
  std::vector<RowSegmentVoxels>
      row_segments;     ///< in the order given; row segments without a column in the tile are left out
  LeafSizePairs pairs;  ///< of the hits counted here; summed over a scan they tell the leaves' size
};

/// Centre of a voxel column in plan, map coordinates.
Eigen::Vector2d column_center(const RowSegment& row_segment, int along, int across);

/// Counts the segments of one tile into the voxels of all row segments that touch it. add() from one thread at a time;
/// for more threads give each its own copy (they share the geometry) and merge(): sums are integers, so any split of
/// the segments gives the same result.
class VoxelAccumulator {
 public:
  /// Errors: usage (options, row segments with no voxels or a size that is not positive).
  static Result<VoxelAccumulator> create(const tile::TileRef& tile, std::span<const RowSegment> row_segments,
                                         std::span<const WoodCylinder> wood, const VoxelOptions& options);
  /// Errors: resources, after 2³²−1 segments.
  Result<void> add(const tile::SegmentBatch& segments);
  /// Counts neighbouring beams only (TileVoxels::pairs), as add() does: to tell the leaves' size before voxels are
  /// fitted to it.
  void add_pairs(const tile::SegmentBatch& segments);
  Result<void> merge(const VoxelAccumulator& other);
  TileVoxels finish() &&;

  /// No column of any row segment lies in the tile: nothing to count.
  bool empty() const;

 private:
  struct Geometry;
  struct Ray {
    Eigen::Vector3d origin, direction;
    double length;
    bool hit, starts;
  };
  struct Counted {
    bool hit = false;      ///< in a voxel of this tile
    bool on_wood = false;  ///< the ray ends on masked wood
  };
  /// `mask`: what the ray can meet (VoxelIndex::candidates); cleared.
  Counted count(const Ray& ray, std::vector<std::uint64_t>& mask);
  /// What count() returns, without counting.
  Counted locate_hit(const Ray& ray, std::vector<std::uint64_t>& mask) const;
  /// Passes every ray that is not left out to `meet(ray, mask)`, and what it returns on neighbouring beams to pairs_.
  template <class Meet>
  void for_rays(const tile::SegmentBatch& segments, Meet meet);
  explicit VoxelAccumulator(std::shared_ptr<const Geometry> geometry);
  std::shared_ptr<const Geometry> geometry_;
  std::vector<RowSegmentVoxels> sums_;
  LeafSizePairs pairs_;
  std::uint64_t segments_ = 0;
};

}  // namespace rayfield::density
