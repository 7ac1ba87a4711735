#pragma once
/// pose: a turn and a shift fitted to landmarks, and the hypotheses among which one is chosen.
#include "libalign/evidence/evidence.h"

namespace rayfield::align {

/// Fits yaw and shift in plan to matched uprights, from `start`, by robust least squares (Ceres; Cauchy loss of 3 cm),
/// matching anew with a shrinking radius; then the height to the ground. Keeps `start` where fewer than three match.
PlanShift fit_pose(const LandmarkPair& pair, const PlanShift& start);

}  // namespace rayfield::align
