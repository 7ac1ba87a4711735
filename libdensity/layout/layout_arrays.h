#pragma once

#include <span>
#include <vector>

#include "libdensity/layout/canopy_map.h"
#include "libdensity/layout/posts.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

/// Stored forms of what leads to the lay-out of a block. All readers answer ErrorCode::damaged, naming what does not
/// fit.
namespace rayfield::density {

/// Kind "rows" version 1: rows, panels, posts and trunks.
tile::ArraySet layout_to_arrays(const RowLayout& layout);
Result<RowLayout> layout_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
