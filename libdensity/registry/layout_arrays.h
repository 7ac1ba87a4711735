#pragma once

#include <string>

#include "libdensity/layout/row_layout.h"
#include "libdensity/posts/posts.h"
#include "libdensity/rows/canopy_map.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

/// Stored forms of what leads to the lay-out of a block. All readers answer ErrorCode::damaged, naming what does not
/// fit.
namespace rayfield::density {

/// Version 1 of the kinds that hold a layout ("rows", "survey", "found"): rows, panels, posts and trunks. Columns of
/// identities and names may be missing and are then empty, as in layouts stored before there were any.
tile::ArraySet layout_to_arrays(const RowLayout& layout, const std::string& kind = "rows");
Result<RowLayout> layout_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
