#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "libdensity/echoes/echo_statistics.h"
#include "libdensity/echoes/full_echoes.h"
#include "libdensity/echoes/leaf_angle.h"
#include "libdensity/voxels/beam_view.h"
#include "libdensity/voxels/voxel_grid.h"
#include "libdensity/voxels/wood.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

struct RayPiece;

/// Counts the segments of one tile into the voxels of all row segments that touch it. add() from one thread at a time;
/// for more threads give each its own copy (they share the geometry) and merge(): sums are integers, so any split of
/// the segments gives the same result.
class VoxelAccumulator {
 public:
  /// Errors: usage (options, row segments with no voxels or a size that is not positive).
  /// `view`: of beams that are not thin; with it EchoCounters are counted too.
  static Result<VoxelAccumulator> create(const tile::TileRef& tile, std::span<const RowSegment> row_segments,
                                         std::span<const WoodCylinder> wood, const VoxelOptions& options,
                                         std::shared_ptr<const BeamView> view = nullptr);
  /// Errors: resources, after 2³²−1 segments.
  Result<void> add(const tile::SegmentBatch& segments);
  /// Counts neighbouring beams only (TileVoxels::pairs), as add() does: to tell the leaves' size before voxels are
  /// fitted to it. With a BeamView the strength of the echoes, too, and the echoes themselves of a share of the places.
  void add_pairs(const tile::SegmentBatch& segments);
  /// From here on only add_pairs() is called: the voxels' counters are given back.
  void count_pairs_only();
  /// From here on add() does not count neighbouring beams, which takes time where several beams are sent at a time.
  void leave_out_pairs() { counts_pairs_ = false; }
  /// From here on add() counts RowSegmentVoxels::directions and nothing else, of `count` row segments from the one at
  /// `first` on. Of beams that are not thin BeamView::full_echo has to be known.
  void count_directions_only(std::size_t first, std::size_t count);
  /// Of the voxels of each row segment that has any in the tile.
  std::vector<std::size_t> voxel_counts() const;
  /// `share`: of the plan, whose echoes add_pairs() keeps for take_leaf_echoes().
  void keep_leaf_echoes(double share) { kept_share_ = share; }
  std::vector<LeafEcho> take_leaf_echoes() { return std::exchange(leaf_echoes_, {}); }
  Result<void> merge(const VoxelAccumulator& other);
  TileVoxels finish() &&;
  /// Of add_pairs(); nothing for thin beams.
  const std::optional<EchoStatistics>& echo_statistics() const { return statistics_; }

  /// Of its counters: what a copy of it takes.
  std::size_t bytes() const;
  /// No column of any row segment lies in the tile: nothing to count.
  bool empty() const;

 private:
  struct Geometry;
  struct Ray {
    Eigen::Vector3d origin, direction;
    double length;
    bool hit, starts;
    double range_m = 0;           ///< of the origin from the sensor; beams that are not thin
    std::uint16_t intensity = 0;  ///< of the hit
  };
  /// A row segment that a ray meets: the ray in voxel coordinates, and its part inside.
  struct Met {
    std::size_t item;
    Eigen::Vector3d g0, dg;
    double from, to;
  };
  struct Counted {
    bool hit = false;                    ///< in a voxel of this tile
    bool on_wood = false;                ///< the ray ends on masked wood
    bool on_ground = false;              ///< of add_pairs(): it ends near the ground, and meets no row
    const WoodCylinder* wood = nullptr;  ///< of locate_hit(): which
  };
  /// `mask`: what the ray can meet (VoxelIndex::candidates); cleared.
  Counted count(const Ray& ray, std::vector<std::uint64_t>& mask);
  /// What count() returns, without counting.
  Counted locate_hit(const Ray& ray, std::vector<std::uint64_t>& mask) const;
  /// As count() of a beam that is not thin: the row segments of candidates_ in the ray's order, and the path behind its
  /// echo. Returns Counted::hit.
  bool count_wide(const Ray& ray, std::span<const RayPiece> pieces, bool on_wood);
  /// Into met_: the grids among the candidates that the ray crosses up to `end`, in its order.
  void meet_grids(const Ray& ray, double end);
  /// As count(), into the counters of directions. Of beams that are not thin only what they meet in their first 1.5 m
  /// inside grids: deeper in they have lost more (docs/beams.md), level ones more than steep ones.
  void count_directions(const Ray& ray, std::span<const RayPiece> pieces, bool on_wood);
  /// Into statistics_ and leaf_echoes_.
  void add_echo(const Ray& ray, const Counted& counted);
  /// Passes every ray that is not left out to `meet(ray, mask)`, and what it returns on neighbouring beams to pairs_
  /// and statistics_.
  template <class Meet>
  void for_rays(const tile::SegmentBatch& segments, Meet meet);
  VoxelAccumulator(std::shared_ptr<const Geometry> geometry, std::vector<RowSegmentVoxels> empty);
  std::shared_ptr<const Geometry> geometry_;
  std::vector<RowSegmentVoxels> sums_;
  LeafSizePairs pairs_;
  std::optional<EchoStatistics> statistics_;  // once add_pairs() is called with a view
  std::vector<LeafEcho> leaf_echoes_;
  double kept_share_ = 0;
  bool counts_pairs_ = true, counts_directions_ = false;
  // Of one ray; kept for their memory. Row segments that it can meet, and those that it does.
  std::vector<std::size_t> candidates_;
  std::vector<Met> met_;
  std::uint64_t segments_ = 0;
};

}  // namespace rayfield::density
