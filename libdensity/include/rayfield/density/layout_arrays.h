#pragma once

#include <span>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/density/canopy_map.h"
#include "rayfield/density/posts.h"
#include "rayfield/density/row_layout.h"
#include "rayfield/tile/arrays.h"

/// Stored forms of what leads to the lay-out of a block. All readers answer ErrorCode::damaged, naming what does not
/// fit.
namespace rayfield::density {

/// Kind "rows" version 1: rows, panels, posts and trunks.
tile::ArraySet layout_to_arrays(const RowLayout& layout);
Result<RowLayout> layout_from_arrays(const tile::ArraySet& arrays);

/// Kind "stems" version 1: one tile's stems.
tile::ArraySet stems_to_arrays(std::span<const Stem> stems);
Result<std::vector<Stem>> stems_from_arrays(const tile::ArraySet& arrays);

/// Kind "canopy" version 1: one tile's canopy map.
tile::ArraySet canopy_to_arrays(const CanopyTile& tile);
Result<CanopyTile> canopy_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
