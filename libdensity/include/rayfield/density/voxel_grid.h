#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/density/leaf_angle.h"
#include "rayfield/density/leaf_size.h"
#include "rayfield/density/row_layout.h"
#include "rayfield/density/wood.h"
#include "rayfield/tile/segments.h"

/// Counting rays in the voxels of one tile (method, section 5).
namespace rayfield::density {

struct VoxelOptions {
  LeafAngles leaf_angles;  ///< G(θ) of the path sums; changing it means counting again
  /// Widening of known wood (m): range noise spreads hits on a post about its surface. Three standard deviations of
  /// the range noise lose 0.1 % of them; what is masked in vain only lowers the ray count. Valid: 0…0.2.
  double wood_shell_m = 0.045;
  /// Ray clouds hold no downward rays that came back from nowhere (their length is unknown), so a ray that runs down at
  /// a small angle is in the cloud if a leaf stopped it and missing if not, and the canopy looks too dense, thin ones
  /// most. So rays that go down and would not reach the tile's ground, taken as a plane, within this distance are left
  /// out, whatever they met. Shorter costs the view of the canopy at the sensor's height; longer than the range from
  /// which bare ground returns is in vain. 0 = count all: right where the scan holds such rays (process() sees that by
  /// itself: holds_downward_misses()). Valid: 0…200 m; about three quarters of the lidar's range.
  double sure_return_m = 30;
  double slope_margin = 0.02;  ///< how much more than the plane the ground may fall away. Valid: 0…0.5
  Result<void> validate() const;
};

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
/// for more threads give each its own accumulator (fork()) and merge(): sums are integers, so any split of the
/// segments gives the same result.
class VoxelAccumulator {
 public:
  /// `tile_size_m`: the store's. Errors: usage (options, row segments with no voxels or a size that is not positive).
  static Result<VoxelAccumulator> create(tile::TileIndex tile, double tile_size_m,
                                         std::span<const RowSegment> row_segments, std::span<const WoodCylinder> wood,
                                         const VoxelOptions& options);
  VoxelAccumulator(VoxelAccumulator&&) noexcept;
  VoxelAccumulator& operator=(VoxelAccumulator&&) noexcept;
  ~VoxelAccumulator();

  /// Another accumulator over the same voxels, all zero; shares the geometry.
  VoxelAccumulator fork() const;
  /// Errors: resources, after 2³²−1 segments.
  Result<void> add(const tile::SegmentBatch& segments);
  /// Counts neighbouring beams only (TileVoxels::pairs), as add() does: to tell the leaves' size before voxels are
  /// fitted to it.
  void add_pairs(const tile::SegmentBatch& segments);
  Result<void> merge(const VoxelAccumulator& other);
  TileVoxels finish() &&;

  /// No column of any row segment lies in the tile: nothing to count.
  bool empty() const;
  std::size_t memory_bytes() const;

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
