#pragma once

#include <span>
#include <string>
#include <vector>

#include "libdensity/pipeline/derive.h"
#include "rayfield/core/products.h"
#include "rayfield/density/process.h"
#include "rayfield/density/row_segments.h"

namespace rayfield::density {

/// What the stages of one scan share.
struct ScanWork {
  const tile::Store& store;
  const tile::ScanEntry& scan;
  const ProcessOptions& options;
  Derivation& files;
  Progress& progress;
  int threads = 1;
  VoxelOptions voxels = {};     ///< the options', or for a scan with all its rays: count all
  std::string layout_key = {};  ///< names the layout in the keys of what depends on it

  double tile_size_m() const { return store.config().tile_size_m; }
};

/// ErrorCode::interrupted once the user asked to stop.
Result<void> check_cancelled(const Progress& progress);

/// The first stages, which need nothing but the rays.
struct SurveyedScan {
  std::vector<TileSurvey> surveys;  ///< in the order of the scan's tiles
  GroundModel ground;
};
Result<SurveyedScan> survey_scan(ScanWork& work);

/// Rows, posts and panels from one scan: the block's layout, when there is none yet.
struct FoundLayout {
  RowLayout layout;
  std::vector<std::string> notes;
};
Result<FoundLayout> find_layout(ScanWork& work, const SurveyedScan& surveyed);

/// Hits across and above the rows (kind "profile"): where the canopy ends.
Result<CanopyProfile> profile_canopy(ScanWork& work, const RowLayout& layout, const GroundModel& ground);

/// Side of the scan's voxels, m: as given, or fitted to the leaves that a sample of the rays shows (kind "voxelsize").
Result<double> choose_voxel_size(ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                                 const CanopyProfile& profile, std::span<const WoodCylinder> wood);

/// The voxel grids of the scan's rows (kind "stretches").
Result<RowSegmentList> cut_row_segmentes(ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                                         const CanopyProfile& profile, double voxel_m);

/// What can be met in one tile.
struct TileScene {
  std::vector<RowSegment> row_segments;
  std::vector<WoodCylinder> wood;
};
TileScene scene_of(tile::TileIndex index, double tile_size_m, double margin_m, const RowSegmentList& list,
                   std::span<const WoodCylinder> wood);

/// Counts rays in the voxels of every tile that a row segment touches; the counters stay in the store (kind "voxels").
/// Returns the tiles that have any, in order.
Result<std::vector<tile::TileIndex>> count_voxels(ScanWork& work, const RowSegmentList& row_segments,
                                                  std::span<const WoodCylinder> wood);

/// Panels, half metres, sections and rasters from the counters (kinds "results" and "raster").
Result<ScanResults> integrate_scan(ScanWork& work, const RowLayout& layout, const SurveyedScan& surveyed,
                                   const RowSegmentList& row_segments, std::span<const WoodCylinder> wood,
                                   std::span<const tile::TileIndex> tiles);

}  // namespace rayfield::density
