#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "libdensity/echoes/leaf_size_pairs.h"
#include "libdensity/layout/row_layout.h"
#include "libdensity/leaf_angles/direction_counters.h"
#include "rayfield/tile/segments.h"

/// voxels: the voxel grids of rows, and the rays, hits and path lengths counted in them (docs/density.md).
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

/// What beams that are not thin add to the counters of a voxel (docs/beams.md, "How it is taken out"); u as in
/// VoxelCounters. Integers as there, paths in units of 2⁻¹³, so that no product overflows before `rays` does.
struct EchoCounters {
  std::int64_t echo = 0;         ///< Σ intensity of the hits
  std::int64_t width = 0;        ///< Σ u · diameter of the beam, 10 µm
  std::int64_t behind = 0;       ///< Σ u within BeamView::behind_m behind the echoes
  std::int64_t echo_behind = 0;  ///< Σ u behind · intensity of the echo
  static constexpr double kPathUnit = 1.0 / (1 << 13), kWidthUnitM = 1e-5;
  static std::int64_t path_units(double u) { return std::llrint(u * (1 / kPathUnit)); }
  static std::int64_t width_units(double width_m) { return limited(width_m * (1 / kWidthUnitM)); }
  EchoCounters& operator+=(const EchoCounters& other);
  bool operator==(const EchoCounters&) const = default;

 private:
  static std::int64_t limited(double units) { return std::llrint(std::clamp(units, 0.0, 65535.0)); }
};

/// The voxels of one row segment whose columns belong to one tile: a column belongs to the tile that holds its centre.
struct RowSegmentVoxels {
  RowSegment row_segment;
  std::vector<std::int32_t> column;  ///< n_along·n_across, [along·n_across + across]: number of the column here, or -1
  std::vector<std::uint32_t> entries;  ///< per column here: rays that enter the row's grid there (through any face but
                                       ///< the ends of the row segment) or start there; each ray once
  std::vector<VoxelCounters> voxels;   ///< [column·n_up + up]
  std::vector<EchoCounters> echoes;    ///< likewise, empty for thin beams
  std::vector<DirectionCounters> directions;  ///< likewise, empty but of count_directions_only()

  /// The voxels of a column from the bottom up; an empty span if they belong to another tile.
  /// Echoes likewise.
  std::span<const VoxelCounters> column_voxels(int along, int across) const { return column_of(voxels, along, across); }
  std::span<const EchoCounters> column_echoes(int along, int across) const { return column_of(echoes, along, across); }

 private:
  template <class T>
  std::span<const T> column_of(const std::vector<T>& values, int along, int across) const {
    const std::int32_t c = column[row_segment.shape().column(along, across)];
    if (c < 0 || values.empty()) return {};
    const auto n = static_cast<std::size_t>(row_segment.n_up);
    return std::span(values).subspan(static_cast<std::size_t>(c) * n, n);
  }
};

/// Memory that the counters take.
std::size_t counter_bytes(std::span<const RowSegmentVoxels> row_segments);

/// What one tile of one scan knows of the voxels in it.
struct TileVoxels {
  tile::TileIndex tile;
  std::vector<RowSegmentVoxels>
      row_segments;     ///< in the order given; row segments without a column in the tile are left out
  LeafSizePairs pairs;  ///< of the hits counted here; summed over a scan they show the size of the leaves
};

/// Centre of a voxel column in plan, map coordinates.
Eigen::Vector2d column_center(const RowSegment& row_segment, int along, int across);

/// Voxels of a row segment in whose columns nothing has been counted; `wide`: with EchoCounters. Columns of other tiles
/// are −1.
RowSegmentVoxels empty_voxels(const RowSegment& row_segment, const tile::TileRef& tile, bool wide);

}  // namespace rayfield::density
