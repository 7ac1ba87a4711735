#pragma once
/// rows: passes of the vehicle, a map of the canopy's hits, and the rows found in both (docs/rows.md).
#include <Eigen/Core>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libdensity/layout/row_layout.h"
#include "libdensity/rows/canopy_map.h"
#include "libdensity/rows/passes.h"
#include "rayfield/core/result.h"
#include "rayfield/density/layout_options.h"

namespace rayfield::density {

/// Something that looked like a row and was not taken.
struct RejectedRow {
  std::vector<Eigen::Vector2d> line;
  std::string reason;
};

struct RowFindings {
  RowLayout layout;  ///< rows and spacing; no posts or panels yet
  std::vector<RejectedRow> rejected;
};

/// Which part of a line was driven along on its left and on its right, each 0…1.
std::pair<double, double> driven_shares(std::span<const Eigen::Vector2d> line, std::span<const Pass> passes,
                                        const RowOptions& options);

/// Share of a line's vertices that lie beside another line, closer than `distance_m`.
double share_beside(std::span<const Eigen::Vector2d> line, std::span<const Eigen::Vector2d> other, double distance_m);

/// Finds all rows that were driven along. No passes or no canopy gives an empty layout (not an error).
/// Rows are numbered from 1 from the left of the canonical direction: northward, or eastward for rows within 15° of
/// east-west; every centreline points that way. Rows of other directions (sub-blocks) follow, each group ordered so.
Result<RowFindings> find_rows(std::span<const PathPoint> path, const CanopyMap& canopy, const RowOptions& options);

}  // namespace rayfield::density
