#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/density/ground_model.h"
#include "rayfield/density/row_layout.h"
#include "rayfield/tile/arrays.h"
#include "rayfield/tile/segments.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// The voxel grids of a scan: extents per row from the canopy's end points (paper, appendix Voxelisation), cut into
/// straight row segments that follow the centreline and the ground.
struct RowSegmentOptions {
  double voxel_m = 0.08;        ///< 0.03…0.3; see docs/density.md, "Voxel size"; the paper has 0.12
  int voxels_per_segment = 38;  ///< 4…200; 38 × 0.08 = 3.04 m; shorter follows curves and relief more closely
  double up_min_m = 0.30;       ///< low face above the ground, 0…1.5
  double across_low = 0.02, across_high = 0.98;  ///< quantiles of end points across the row
  double up_high = 0.97;                         ///< quantile of end points upwards
  /// Voxels added beyond the quantiles on both sides and on top, 0…10. The quantiles cut outliers and leaves alike:
  /// they leave 4 % of the hits outside across and 3 % above. Empty voxels add nothing to a sum, so a voxel more costs
  /// memory and time only (see docs/rows.md for what it brings).
  int widen_voxels = 2;
  double min_half_width_m = 0.24;  ///< 0.05…2
  double min_height_m = 0.60;      ///< least height of the grid above its low face, 0.1…3
  double max_height_m = 4.0;       ///< hits higher above the ground are no canopy, 1.5…8
  double lone_half_width_m = 1.5;  ///< how far a canopy may reach where there is no neighbouring row, 0.3…3
  Result<void> validate() const;
};

/// The same options with voxels of another size and row segments of about the same length.
RowSegmentOptions with_voxel_size(const RowSegmentOptions& options, double voxel_m);

/// Hits of one scan across and above each row.
struct CanopyProfile {
  double bin_m = 0.02;
  double half_width_m = 1.5, up_min_m = 0.3;
  std::map<int, std::vector<std::int64_t>> across, up;  ///< by Row::number; bins from −half_width_m and from up_min_m
};

/// Collects a CanopyProfile over one tile after another; order does not matter.
class CanopyProfileAccumulator {
 public:
  /// `layout` and `ground` must outlive the accumulator.
  CanopyProfileAccumulator(tile::TileIndex index, double tile_size_m, const RowLayout& layout,
                           const GroundModel& ground, const RowSegmentOptions& options);
  ~CanopyProfileAccumulator();
  CanopyProfileAccumulator(const CanopyProfileAccumulator&);
  CanopyProfileAccumulator& operator=(const CanopyProfileAccumulator&) = delete;
  CanopyProfileAccumulator(CanopyProfileAccumulator&&) noexcept;
  CanopyProfileAccumulator& operator=(CanopyProfileAccumulator&&) noexcept;
  void add(const tile::SegmentBatch& segments);
  void merge(const CanopyProfileAccumulator& other);
  const CanopyProfile& finish() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

Result<CanopyProfile> canopy_profile_of_tile(const tile::Store::TileReader& reader, tile::TileIndex index,
                                             double tile_size_m, const RowLayout& layout, const GroundModel& ground,
                                             const RowSegmentOptions& options, int threads);

/// Adds the profile of another tile of the same scan.
void add_profile(CanopyProfile& total, const CanopyProfile& tile);

/// The grid's faces for one row of one scan.
struct RowExtents {
  int row = 0;
  std::int64_t hits = 0;
  double across_low_m = 0, across_high_m = 0, up_high_m = 0;  ///< the quantiles; NaN without hits
  double across_min_m = 0, across_max_m = 0, up_max_m = 0;    ///< faces, whole voxels
  double outside_share = 0;  ///< of the hits beyond the faces (across plus above), an upper bound of what is cut off
};

/// Faces from quantiles, widened, at least the minimum and at most half the row spacing, snapped to whole voxels.
/// Rows without hits get the minimum, so that they are reported as scanned and empty where rays cross them.
std::vector<RowExtents> row_extents(const RowLayout& layout, const CanopyProfile& profile,
                                    const RowSegmentOptions& options);

struct RowSegmentList {
  std::vector<RowSegment> row_segments;  ///< by row, then along
  std::vector<RowExtents> extents;
  std::vector<std::string> warnings;  ///< row segments left out, with the reason
};

/// Cuts every row into row segments. A row segment whose ground is unknown is left out and named in the warnings.
Result<RowSegmentList> make_row_segmentes(const RowLayout& layout, const GroundModel& ground,
                                          const CanopyProfile& profile, const RowSegmentOptions& options);

/// Stored form, kind "stretches" version 1.
tile::ArraySet row_segments_to_arrays(const RowSegmentList& list);
/// Errors: damaged. Warnings are not stored.
Result<RowSegmentList> row_segments_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
