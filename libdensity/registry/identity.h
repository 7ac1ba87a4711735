#pragma once

#include <string>
#include <string_view>

#include "libdensity/layout/row_layout.h"

namespace rayfield::density {

/// Gives a UUID to every row, panel and post that has none: named UUIDs of the places in map `crs`, to the centimetre,
/// so that the same block gets the same ones on every machine. Layouts that were stored without identities
/// thereby keep the UUIDs that their products had.
void name_by_place(RowLayout& layout, const std::string& crs);

/// Gives what stands in `layout` the identities (UUID, dates, farm's number and name) of what stands at the same place
/// in `known`: rows beside each other along most of the shorter one, posts within 0.25 m of each other, panels of the
/// same row with both borders within 0.5 m. Each identity is given once, to the nearest. What has a UUID of `known`
/// already keeps it.
void take_over_identities(const RowLayout& known, RowLayout& layout);

/// The layout as a scan of that date takes it: rows in use then, with their panels, posts and trunks. Posts whose wood
/// is not in use on the date have detected = false.
RowLayout layout_on(const RowLayout& layout, std::string_view date);

}  // namespace rayfield::density
