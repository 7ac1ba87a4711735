#pragma once

#include <optional>

#include "libslam/surfels/range_resolution.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/slam/options.h"
#include "rayfield/slam/report.h"

/// How aslant a wide beam may meet a plane that is still measured where it is (docs/slam.md, "Wide beams").
namespace rayfield::slam {

struct SpotDepth {
  double limit_m = 0;  ///< for SurfelOptions::max_spot_depth_m
  std::optional<RangeResolution> measured;
  double seconds = 0;  ///< that it took
};

/// The limit that the options give, else the range resolution that the rig states, else, for a wide beam of a lidar
/// that reports the first echo, that which the first minute of the log tells, else 0.15 m. Errors: those of reading the
/// log; a minute that cannot be reconstructed only leaves the limit unmeasured.
Result<SpotDepth> choose_spot_depth(const LogReader& read, const Rig& rig, const SlamOptions& options,
                                    Progress& progress);

void note_spot_depth(const Rig& rig, const SpotDepth& spots, SlamReport& report);

}  // namespace rayfield::slam
