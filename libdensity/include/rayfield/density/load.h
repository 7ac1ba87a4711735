#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// Names of the rasters that process() leaves in the store for every scan.
inline constexpr const char* kRasterNames[] = {"plan_density", "plan_density_se", "canopy_height", "ground"};

/// And this one for scans whose wood is known.
inline constexpr const char* kLeafRasterName = "leaf_density";
/// Those that the store holds for a scan, in that order.
std::vector<std::string> raster_names(const tile::ScanEntry& scan);

/// Of scans whose wood no dormant scan shows.
inline constexpr const char* kWoodIsEstimated =
    "without a dormant scan cordons, canes, branches and wires are estimated from the canopy's size: the intervals of "
    "leaf areas are wide, and a scan of the bare vines will narrow them";
/// And where they are not estimated either.
inline constexpr const char* kWoodInLeafArea = "leaf area holds canes and wires: the block has no dormant scan";

/// The block's rows, panels, posts and the results of the scans named (all that have any if empty), in the order of
/// their dates.
/// Without the sections, which are large: see load_sections().
/// Errors: usage (nothing processed yet, unknown scan), damaged.
Result<BlockProducts> load_block(const tile::Store& store, const tile::Snapshot& snapshot,
                                 const std::vector<std::string>& scan_ids);

/// Sections of one scan whose names begin with `name_prefix` ("side_view", "end_on"), of one row or of all, by row.
/// Errors: usage (not processed yet), damaged.
Result<std::vector<SectionProduct>> load_sections(const tile::Store& store, const tile::Snapshot& snapshot,
                                                  const tile::ScanEntry& scan, const std::string& name_prefix,
                                                  std::optional<int> row_number = std::nullopt);

/// A raster that is read by rows, not in memory as a whole. From one thread at a time.
class StoredRaster {
 public:
  /// What it is and where it lies; its grid holds no values.
  const RasterProduct& product() const;
  /// Rows iy_begin … iy_begin + row_count − 1, each product().grid.nx values. Errors: damaged.
  Result<void> read_rows(int iy_begin, int row_count, std::span<float> values) const;

 private:
  friend Result<StoredRaster> open_raster(const tile::Store&, const tile::Snapshot&, const tile::ScanEntry&,
                                          const std::string&);
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// One raster of one scan, in the frame that all dates of the block share: rasters of one name and cell size lie cell
/// upon cell. Errors: usage (not processed yet), damaged.
Result<StoredRaster> open_raster(const tile::Store& store, const tile::Snapshot& snapshot, const tile::ScanEntry& scan,
                                 const std::string& name);
/// The same in memory.
Result<RasterProduct> load_raster(const tile::Store& store, const tile::Snapshot& snapshot, const tile::ScanEntry& scan,
                                  const std::string& name);

/// Scans whose id or date is among `wanted` (all if empty). Errors: usage, naming what is not there.
Result<std::vector<std::string>> select_scans(const tile::Snapshot& snapshot, const std::vector<std::string>& wanted);

/// Scans for products.
struct SelectedResults {
  std::vector<std::string> scan_ids;
  std::vector<std::string> left_out;  ///< a line for each scan that was not asked for by name and has no results
};

/// As select_scans(), but one bad scan does not keep the others from their products: if `wanted` is empty, scans
/// without results are left out. Errors: usage, also where no scan has results.
Result<SelectedResults> select_results(const tile::Snapshot& snapshot, const std::vector<std::string>& wanted);

}  // namespace rayfield::density
