#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/density/canopy_map.h"
#include "rayfield/density/estimator.h"
#include "rayfield/density/ground.h"
#include "rayfield/density/integrate.h"
#include "rayfield/density/plan_raster.h"
#include "rayfield/density/posts.h"
#include "rayfield/density/row_segments.h"
#include "rayfield/density/rows.h"
#include "rayfield/density/survey.h"
#include "rayfield/density/voxel_grid.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// Voxels fitted to the leaves (docs/density.md, "Voxel size"): leaves that reach out of a small voxel shade it, and
/// uneven density inside a large one is underestimated. The side is `leaf_sides` times that of a square as
/// large as the leaves look, in whole millimetres.
struct VoxelFitOptions {
  bool enabled = true;       ///< false: RowSegmentOptions::voxel_m rules
  double leaf_sides = 0.85;  ///< 0.5…5; larger underestimates clumped canopies, smaller overestimates large leaves
  double min_m = 0.06;       ///< 0.03…0.3
  double max_m = 0.12;       ///< min_m…0.3; the paper's size
  double sample_m = 0.08;    ///< side of the voxels by which it is told before what is a leaf, 0.03…0.3
  Result<void> validate() const;
};

/// Everything that can be set about the way from tiles to maps; each part documents itself.
struct ProcessOptions {
  SurveyOptions survey;
  GroundOptions ground;
  CanopyMapOptions canopy;
  RowOptions rows;
  PostOptions posts;
  RowSegmentOptions segments;
  VoxelFitOptions voxel_fit;
  VoxelOptions voxels;
  EstimatorOptions estimator;
  IntegrationOptions integration;
  PlanRasterOptions plan;

  std::vector<std::string> dates;                       ///< scan ids or dates to process; empty = all
  bool redo = false;                                    ///< make everything anew, the layout with it
  int threads = 0;                                      ///< 0 = all processors
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< bounds what is kept of tiles that will be needed again
  Result<void> validate() const;
};

/// What became of one scan.
struct ScanReport {
  std::string scan_id;
  std::uint64_t rays = 0;
  std::size_t files_made = 0, files_kept = 0;
  double plant_area_m2 = 0;  ///< sum over the panels
  double leaf_size_m2 = 0;   ///< area of one leaf, as measured or given
  double voxel_m = 0;        ///< side of the voxels
  std::vector<std::string> notes;
};

struct ProcessReport {
  std::size_t rows = 0, panels = 0, posts = 0;
  bool layout_is_new = false;
  std::vector<ScanReport> scans;
  std::vector<std::string> notes;  ///< about the block: rows refused, posts not seen
};

/// Runs ground ▸ rows ▸ voxels ▸ density ▸ panels ▸ rasters over the store's scans. Files that exist under the same
/// key are kept. The layout (rows, posts, panels) is found in the first scan of the store that shows one and kept.
/// Errors: usage (options, nothing added, unknown scan), bad_input (no rows found, with the reason), damaged,
/// resources, locked, interrupted.
Result<ProcessReport> process(tile::Store& store, const ProcessOptions& options, const std::string& command,
                              Progress& progress);

}  // namespace rayfield::density
