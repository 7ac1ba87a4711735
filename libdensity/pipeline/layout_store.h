#pragma once

#include <string>
#include <vector>

#include "libdensity/layout/row_layout.h"
#include "libdensity/pipeline/scan_stages.h"

namespace rayfield::density {

/// The block's layout as the store's registry has it: found once, kept for all dates.
struct BlockLayout {
  bool known = false;
  RowLayout layout;
  std::string key;                 ///< names it in the keys of what depends on it
  std::vector<std::string> notes;  ///< what was noticed when it was found
};

/// The layout that the snapshot holds, whatever it was found with.
Result<BlockLayout> read_layout(const tile::Store& store, const tile::Snapshot& snapshot);

/// The layout in the snapshot; not known when there is none, when `options` ask for other rows or panels than it was
/// found with, or when everything shall be made anew.
Result<BlockLayout> load_layout(const tile::Store& store, const tile::Snapshot& snapshot,
                                const ProcessOptions& options);

/// Finds the layout in this scan and makes it the block's.
Result<void> adopt_layout(ScanWork& work, const SurveyedScan& surveyed, tile::Store::DerivedWriter& writer,
                          BlockLayout& block);

}  // namespace rayfield::density
