#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// What became of one scan.
struct ScanReport {
  std::string scan_id;
  std::uint64_t rays = 0;
  std::size_t files_made = 0, files_kept = 0;
  double plant_area_m2 = 0;  ///< sum over the panels that have a value; NaN where none has
  int panels = 0, panels_with_value = 0;
  double observed_fraction = 0;              ///< share of voxels that two rays crossed, mean over all panels
  std::optional<double> leaf_area_m2;        ///< the same; nothing where the wood is not known
  double leaf_low_m2 = 0, leaf_high_m2 = 0;  ///< sums of the ends of the panels' intervals
  std::string wood_scan_id;                  ///< the dormant scan whose wood was subtracted
  std::string wood_from;                     ///< as ScanProduct's
  double leaf_size_m2 = 0;                   ///< area of one leaf, as measured or given
  double voxel_m = 0;                        ///< side of the voxels
  std::vector<std::string> notes;
};

/// A scan that could not be processed; what was made of it before stands as it was.
struct FailedScan {
  std::string scan_id;
  Error error;
};

struct ProcessReport {
  std::size_t rows = 0, panels = 0, posts = 0;
  bool layout_is_new = false;
  std::vector<ScanReport> scans;
  std::vector<FailedScan> failed;
  std::vector<std::string> notes;  ///< about the block: rows refused, posts not seen
  /// Scans that were not asked for, but whose leaf areas would now be made with the wood of another dormant scan.
  std::vector<std::string> outdated_leaf_areas;
};

/// Runs ground ▸ rows ▸ voxels ▸ density ▸ panels ▸ rasters over the store's scans. Files that exist under the same
/// key are kept. The layout (rows, posts, panels) is found in the first scan of the store that shows one and kept.
/// Where the block has a dormant scan, its wood is subtracted from the plants of the others, once all are processed;
/// elsewhere wood is estimated.
/// A scan that cannot be processed does not stop the others: it is listed in `failed`, unless all of them fail.
/// Errors: usage (options, nothing added, unknown scan), bad_input (no rows found, with the reason), damaged,
/// resources, locked, interrupted.
Result<ProcessReport> process(tile::Store& store, const ProcessOptions& options, const std::string& command,
                              Progress& progress);

}  // namespace rayfield::density
