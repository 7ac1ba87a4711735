#pragma once
/// warp: the smooth displacement that is left when turn and shift are done.
#include <vector>

#include "libalign/evidence/evidence.h"
#include "rayfield/align/warp.h"

namespace rayfield::align {

struct WarpFit {
  Warp warp;                     ///< empty where it did not earn its place
  double rigid_left_out_m = 0;   ///< median residual of landmarks that had no part in the fit, without and
  double warped_left_out_m = 0;  ///< with a warp
};

/// Fits a warp to the matches and to the heights of the ground (Ceres; Cauchy loss, second differences of the control
/// points as prior) and keeps it where landmarks that were left out of the fit, a fifth at a time, agree better by
/// options.min_gain. Needs 20 matches.
WarpFit fit_warp(const LandmarkPair& pair, const PlanShift& pose, const std::vector<Match>& matches,
                 const WarpOptions& options);

}  // namespace rayfield::align
