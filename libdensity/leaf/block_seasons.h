#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libdensity/leaf/dormant_scan.h"
#include "libdensity/leaf/leaf_products.h"
#include "libdensity/leaf/scan_totals.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// The scans of a block, in the order of the snapshot, and whose wood stands for which.
class BlockSeasons {
 public:
  /// `processed`: totals of the scans processed just now, by scan id; those of the others are read. `by_estimate`:
  /// where there is no dormant scan, wood is estimated (WoodPriorOptions::enabled).
  static Result<BlockSeasons> read(const tile::Store& store, const tile::Snapshot& snapshot,
                                   const std::map<std::string, ScanTotals>& processed, bool by_estimate);

  /// The dormant scan whose wood is to be subtracted from that of `scan_id`; nothing where the block has none.
  std::optional<WoodScan> wood_for(const std::string& scan_id, const VoxelOptions& voxels) const;
  /// Without one: the scan of the season that shows the least plants, clearly less than this one, if there is one.
  std::optional<BarestScan> barest_for(const std::string& scan_id) const;
  /// Why the scan counts as dormant or, in the leafless months, does not; empty where nobody would ask.
  std::string verdict_on(const std::string& scan_id) const;
  /// True where the leaf areas that the snapshot holds for a processed scan were made with another wood than they would
  /// be now.
  Result<bool> is_outdated(const tile::Store& store, const tile::ScanEntry& scan) const;

 private:
  std::optional<std::size_t> index_of(const std::string& scan_id) const;

  std::vector<const tile::ScanEntry*> entries_;
  std::vector<ScanSeason> scans_;
  std::vector<std::optional<ScanTotals>> totals_;
  std::vector<DormantVerdict> verdicts_;
  std::optional<double> latitude_deg_;
  bool by_estimate_ = false;
};

}  // namespace rayfield::density
