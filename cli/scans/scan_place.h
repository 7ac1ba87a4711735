#pragma once

#include <optional>
#include <string>

#include "rayfield/core/ray_source.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

/// Looks at the first rays of a cloud before any is taken into the store: whether the store's CRS is made for their
/// place, and whether the block's other scans lie there too. `replaced`: the id of a scan that this one takes the place
/// of. A warning, or nothing. Errors: bad_input, naming the cloud; what reading gives.
Result<std::optional<std::string>> check_scan_place(RaySource& cloud, const std::string& crs,
                                                    const tile::Snapshot& latest, const std::string& replaced);

}  // namespace rayfield::cli
