#pragma once

#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/season_products.h"

namespace rayfield::density {

/// The block (row_number 0) and each of its rows on each of its dates, over the panels that were seen; dates in the
/// order of block.scans, the block first. NaN where no panel was seen. The interval adds the independent errors of the
/// panels as squares and those that all voxels share as they are (see comparison.h).
std::vector<SeasonValue> season_values(const BlockProducts& block);

}  // namespace rayfield::density
