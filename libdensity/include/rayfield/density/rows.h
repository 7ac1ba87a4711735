#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/density/canopy_map.h"
#include "rayfield/density/passes.h"
#include "rayfield/density/row_layout.h"

namespace rayfield::density {

/// Rows are traced in the canopy beside every pass, so that they may stand in any direction and curve gently, and are
/// then verified: a lane outside of the block, a headland, a fence or a line of trees makes no row.
struct RowOptions {
  PassOptions passes;
  double min_offset_m = 0.5;         ///< nearest a row can stand to the vehicle's track, 0.2…2
  double max_offset_m = 2.6;         ///< furthest: half the widest lane, 1…6
  double half_width_m = 0.3;         ///< of the core of a canopy, in which its strength is measured, 0.1…1
  double max_gap_m = 6.0;            ///< a longer gap without canopy, post or trunk ends the row, 1…30
  double min_length_m = 5.0;         ///< 2…100
  double min_cover = 0.5;            ///< share of the row with canopy, 0.1…1
  double min_strength_share = 0.25;  ///< of the median row's strength: below = a fence, weeds, 0…1
  double max_tall_share = 0.3;       ///< share of the row under something taller than a vine, 0…1
  double max_lane_share = 0.5;       ///< canopy in the lanes beside, as share of that in the row, 0.1…1
  double smoothing_m = 12.0;         ///< wavelength below which the centreline does not follow, 2…100
  Result<void> validate() const;
};

/// Something that looked like a row and was not taken.
struct RejectedRow {
  std::vector<Eigen::Vector2d> line;
  std::string reason;
};

struct RowFindings {
  RowLayout layout;       ///< rows and spacing; no posts or panels yet
  StraightRun direction;  ///< of the longest straight pass (paper)
  std::vector<Pass> passes;
  std::vector<RejectedRow> rejected;
};

/// Finds all rows that were driven along. No passes or no canopy gives an empty layout (not an error).
/// Rows are numbered from 1 from the left of the canonical direction: northward, or eastward for rows within 15° of
/// east-west; every centreline points that way. Rows of other directions (sub-blocks) follow, each group ordered so.
Result<RowFindings> find_rows(std::span<const PathPoint> path, const CanopyMap& canopy, const RowOptions& options);

/// Median distance of neighbouring rows of one block, rows in the order of their numbers; NaN for a single row.
double row_spacing(std::span<const Row> rows);

/// Orients, orders and numbers rows, and sets the spacing. Deterministic for any order of the input.
void number_rows(RowLayout& layout);

}  // namespace rayfield::density
