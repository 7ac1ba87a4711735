#pragma once
/// estimate: counts become density, row by row (docs/density.md, "Estimating").

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libdensity/echoes/echo_model.h"
#include "libdensity/layout/row_layout.h"
#include "libdensity/voxels/voxel_grid.h"
#include "libdensity/voxels/wood.h"
#include "rayfield/core/result.h"
#include "rayfield/density/estimator.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// Where the value of a voxel comes from.
enum class VoxelState : std::uint8_t {
  unobserved = 0,  ///< fewer than two rays, and nothing comparable near: its density is unknown and counted as 0
  observed = 1,    ///< at least two rays: its share of the slabs that it is part of
  pooled = 2,      ///< at least two rays, but too little path in its slab: value of voxels as badly seen near it
  filled = 3       ///< fewer than two rays: value of its slab, or of badly seen voxels, or mean of others, as deep
};

/// Sums of the densities of two neighbouring cross sections, in voxels and in twice as large ones.
struct TwoSizes {
  double fine = 0, doubled = 0;
};

/// Leaf area density of one row at one date, on one dense grid: the row's row segments side by side. Voxel (along,
/// across, up) has index (along·n_across + across)·n_up + up.
struct RowDensity {
  int row = 0;
  double voxel_m = 0;
  int n_along = 0, n_across = 0, n_up = 0;
  double across_min_m = 0, up_min_m = 0;
  std::vector<RowSegment> row_segments;  ///< of the row, by first_along
  std::vector<std::int32_t> segment_of;  ///< per along index: which row segment
  std::vector<double> chainage_m;        ///< per along index: of its low face
  std::vector<float> density;            ///< m²/m³, everything but masked wood
  std::vector<float> variance;           ///< (m²/m³)²
  std::vector<VoxelState> state;
  bool seen(std::size_t voxel) const {
    return state[voxel] == VoxelState::observed || state[voxel] == VoxelState::pooled;
  }
  std::vector<float> wood_area;        ///< masked wood, m² per voxel (half its surface); empty if there is none
  std::vector<float> free_share;       ///< share of a column outside masked wood, [(along·n_across+across)]; empty = 1
  std::vector<std::uint32_t> entries;  ///< per along index: rays that enter the row there
  double leaf_size_m2 = 0;             ///< of one leaf, as used
  /// What the densities were multiplied with for being uneven inside voxels, per along index, and what told it, per two
  /// of them (correct_uneven_density(); empty of the published method).
  std::vector<double> uneven;
  std::vector<TwoSizes> two_sizes;

  Shape3 shape() const { return {n_along, n_across, n_up}; }
  std::size_t index(int along, int across, int up) const { return shape().index(along, across, up); }
  std::size_t column_index(int along, int across) const { return shape().column(along, across); }
  const RowSegment& row_segment(int along) const { return row_segments[static_cast<std::size_t>(segment_of[along])]; }
  /// Centre of a column in plan, map coordinates.
  Eigen::Vector2d center(int along, int across) const;
  /// One-sided area in a voxel, m², without and with masked wood; 0 where unobserved.
  double canopy_area(int along, int across, int up) const;
  double plant_area(int along, int across, int up) const;
  /// Variance of canopy_area(), m⁴.
  double area_variance(int along, int across, int up) const;
  double wood_area_at(std::size_t voxel) const { return wood_area.empty() ? 0 : static_cast<double>(wood_area[voxel]); }
};

/// Collects the voxels of one row from the tiles it runs through, in any order and one tile at a time, and estimates
/// its density.
class RowDensityBuilder {
 public:
  /// Memory that a row of that shape takes at most, from create() until its RowDensity is dropped: about 100 B per
  /// voxel (56 MB per 100 m of row at 7 cm). `wide`: with a model.
  static std::size_t peak_bytes(const Shape3& shape, bool wide);

  /// `row_segments`: of that row (others are ignored); all with one voxel size, on one lattice across and upwards
  /// (across_min_m and up_min_m whole voxels apart). `wood`: as given to the accumulators. `pairs`: of the whole scan;
  /// tells the leaf size unless the options or the model do. `model`: of beams that are not thin, whose tiles have
  /// EchoCounters; nothing: every echo counts as the hit of a thin ray. Errors: usage.
  static Result<RowDensityBuilder> create(int row, std::span<const RowSegment> row_segments,
                                          std::span<const WoodCylinder> wood, const LeafSizePairs& pairs,
                                          const EstimatorOptions& options,
                                          const std::optional<EchoModel>& model = std::nullopt);
  /// Errors: damaged, when the tile's voxels do not fit the row segments.
  Result<void> add(const TileVoxels& tile);
  RowDensity finish() &&;

 private:
  RowDensity row_;
  EstimatorOptions options_;
  std::optional<EchoModel> model_;
  std::vector<VoxelCounters> counters_;
  std::vector<EchoCounters> echoes_;  // with a model
  std::vector<WoodCylinder> wood_;
};

}  // namespace rayfield::density
