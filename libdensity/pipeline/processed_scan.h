#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libdensity/layout/row_layout.h"
#include "libdensity/leaf/scan_totals.h"
#include "libdensity/learning/block_registry.h"
#include "libdensity/scan/scan_work.h"

namespace rayfield::density {

/// The scans of `dates` (ids or dates; all if empty). Errors: usage, where there are none.
Result<std::vector<std::string>> scans_to_process(const tile::Store& store, const tile::Snapshot& snapshot,
                                                  const std::vector<std::string>& dates);

/// What is left of a scan's processing in kind "processed", so that the next run need not look at the scan again: an
/// update of one date would otherwise read the files of all others. Its key is a hash of everything that the scan's
/// files depend on but for its wood (BlockSeasons::is_outdated()).
struct ProcessedScan {
  double leaf_size_m2 = 0, voxel_m = 0;
  ScanTotals totals = {};
  std::vector<int> rows_from_one_side = {};  ///< ScanVoxels::rows_from_one_side
};

/// `known`: the layout that the scan's evidence was gathered along; `layout`: the one its maps were made with.
std::string processed_key(const ProcessOptions& options, const tile::ScanEntry& scan, const RowLayout& known,
                          const RowLayout& layout);

/// The key by what the block knows already; nothing where the scan's rays have to be looked at first, since there is no
/// layout yet or none of its evidence is in it.
std::optional<std::string> processed_key(const ProcessOptions& options, const tile::ScanEntry& scan,
                                         BlockRegistry& registry);

/// The file that says so; nothing where the scan was not processed whole.
const tile::DerivedEntry* find_processed_entry(const tile::ScanEntry& scan);

/// Keeps it among the scan's files (but for the totals, which have a file of their own).
Result<void> keep_processed(ScanWork& work, const std::string& key, const ProcessedScan& processed);

/// Of a scan that was processed under that key, when all of its files are there; else nothing.
Result<std::optional<ProcessedScan>> find_processed(const ScanWork& work, const std::string& key);

}  // namespace rayfield::density
