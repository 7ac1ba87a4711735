#pragma once

#include <span>

#include "libslam/odometry/window.h"
#include "libslam/pipeline/run_facts.h"
#include "rayfield/core/result.h"
#include "rayfield/slam/report.h"

namespace rayfield::slam {

/// Shares of the matches of a window that agree: in the window where they are fewest, whose middle is at `at_s`, and
/// the median of all windows.
struct WindowAgreement {
  double least = 1, typical = 1, at_s = 0;
};
WindowAgreement window_agreement(std::span<const WindowStats> windows);

/// Adds warnings of what makes a result doubtful to its report, which is complete otherwise.
void add_quality_warnings(const RunFacts& facts, SlamReport& report);

/// Whether the result can be trusted. Errors: bad_input with the reason: surfaces that do not meet again, a trajectory
/// that contradicts GPS or the IMU, motion that no vehicle makes, windows in which hardly any surface matched.
Result<void> check_quality(const RunFacts& facts, const SlamReport& report);

}  // namespace rayfield::slam
