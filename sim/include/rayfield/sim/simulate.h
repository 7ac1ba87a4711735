#pragma once

#include <cstdint>
#include <functional>

#include "rayfield/core/progress.h"
#include "rayfield/core/ray.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/sim/drive.h"
#include "rayfield/sim/world.h"

namespace rayfield::sim {

/// The rig file that belongs to a site: sensors, extrinsics, no-return convention. Topics are Rig's defaults. Time and
/// angle errors of a date are not stated in it: finding them is the estimator's work.
Rig site_rig(const Site& site);

struct SimulateOptions {
  int threads = 0;  ///< 0: all processors; the output does not depend on it
};

struct SimulationSummary {
  std::uint64_t imu_samples = 0, gps_fixes = 0, spinner_angles = 0, lidar_messages = 0;
  std::uint64_t beams = 0;       ///< shots of the lidar
  std::uint64_t hits = 0;        ///< rays that ended at a surface
  std::uint64_t no_returns = 0;  ///< rays to max_range_m (upward; downward where the site keeps them)
  std::uint64_t dropped = 0;     ///< invalid, too close, or downward without a return: not among the rays
};

/// Takes the true registered rays, in the order of their times. An error stops the simulation and is returned.
using RayCallback = std::function<Result<void>(const RayBatch&)>;

/// Runs a drive: hands the sensors' messages to `sink` in the order of their stamps (IMU, spinner, GPS, lidar where
/// they are equal), and to `rays` (may be empty) the ray cloud as measured (with range noise) but placed with the true
/// poses, in the site's map CRS. Upward shots without a return become rays of max_range_m, downward ones are dropped,
/// as are NaN and too close ones. Calls come from one thread at a time, not always the same one.
/// Errors: usage (CRS), interrupted, and what `rays` returns.
Result<SimulationSummary> simulate(const World& world, const Drive& drive, SensorSink& sink, const RayCallback& rays,
                                   const SimulateOptions& options, Progress& progress);

}  // namespace rayfield::sim
