#pragma once

#include <span>
#include <string>
#include <vector>

#include "libdensity/ground/survey.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/density/layout_options.h"
#include "rayfield/density/options.h"
#include "rayfield/tile/snapshot.h"

namespace rayfield::density {

/// Rows (Row::number) that a scan's vehicle drove past on one side only: along at least half of their length there, and
/// not on the other side.
std::vector<int> rows_from_one_side(const RowLayout& layout, std::span<const PathPoint> path,
                                    const RowOptions& options);

/// The options for one row: what the back of a row hides that is seen from its front only is an error of all of its
/// panels, of a factor whose logarithm has the standard error 0.03, and 0.12 where beams are not thin
/// (docs/density.md, "Errors").
IntegrationOptions integration_of_row(const IntegrationOptions& integration, const tile::ScanEntry& scan, int row,
                                      std::span<const int> rows_from_one_side);

/// What is said of them; empty where there are none.
std::string one_side_note(const tile::ScanEntry& scan, const RowLayout& layout,
                          std::span<const int> rows_from_one_side);

}  // namespace rayfield::density
