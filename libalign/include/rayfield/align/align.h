#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rayfield/align/options.h"
#include "rayfield/align/plan_shift.h"
#include "rayfield/align/warp.h"
#include "rayfield/core/landmarks.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/core/result.h"

/// pipeline: aligns a scan to its block's reference by what does not grow (docs/seasons.md, "Alignment").
namespace rayfield::align {

/// Another position of the scan that was considered.
struct Rival {
  double along_rows_m = 0, across_rows_m = 0;  ///< from the accepted position
  double turn_rad = 0;
  double log_ratio = 0;  ///< how much less likely it is, as a natural logarithm
};

/// How a scan is moved, and the evidence for it.
struct Alignment {
  PlanShift shift;
  Warp warp;                     ///< empty: a turn and a shift suffice
  double warp_rms_m = 0;         ///< of its displacements in plan at the matched landmarks
  int landmarks = 0;             ///< posts and trunks seen by both scans
  double shared_fraction = 0;    ///< share of those that stand where both looked
  double residual_m = 0;         ///< median distance of the matched landmarks afterwards, in plan
  double residual_rms_m = 0;     ///< root mean square of those below three times the median
  double ground_residual_m = 0;  ///< median deviation of the ground's height
  double margin = 0;             ///< log-likelihood above the best rival
  std::vector<Rival> rivals;     ///< the likeliest first, at most ten

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const;
};

/// Finds how `scan` must be moved to lie on `reference`. Errors: bad_input, where nothing fits (another block, too few
/// landmarks, ground of another shape) or two positions fit equally well, with figures; usage (options).
/// `name`: of the scan, for messages.
Result<Alignment> align_landmarks(const BlockLandmarks& reference, const BlockLandmarks& scan,
                                  const AlignOptions& options, const std::string& name);

/// The rays of `source`, moved. `source` must outlive it.
std::unique_ptr<RaySource> open_aligned(RaySource& source, const Alignment& alignment);

}  // namespace rayfield::align
