#pragma once

#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/slam/options.h"     // what can be set
#include "rayfield/slam/report.h"      // what a run says of itself
#include "rayfield/slam/trajectory.h"  // the result
#include "rayfield/slam/unwarp.h"      // log + trajectory → rays

/// From a vehicle's log to its trajectory (run_slam) and from both to a ray cloud (Unwarper, open_unwarped):
///
///   pass 1  log ─▶ lidar points in the IMU frame ─▶ sliding window: IMU integration, surfels, non-rigid registration
///           ─▶ levelled and laid onto GPS ─▶ global registration with revisits ─▶ GPS released ─▶ map frame
///   pass 2  log + trajectory ─▶ rays, streamed
///
/// Frames: IMU (the rig's reference), world (levelled, arbitrary yaw), ENU (east, north, up at the median fix), map
/// (projected CRS). Same log, rig and options give the same trajectory to the last bit at any number of threads.
namespace rayfield::slam {

/// A fix in map coordinates, for plots.
struct GpsMark {
  double time_s = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  bool outlier = false;
};

struct SlamResult {
  Trajectory trajectory;
  SensorOffsets offsets;  ///< for the Unwarper
  std::vector<GpsMark> gps;
  SlamReport report;
};

/// Reconstructs one drive. `crs`: a projected CRS, or empty for a local frame. Without usable GPS the frame is local
/// whatever `crs` says, and the report states it.
/// With offsets to be estimated (Rig) the log is gone through twice: the first pass finds nine tenths of them.
/// Memory: the trajectory and what comes with it (40 kB per second of driving), a few seconds of points, and the
/// surfels of a square of 32 m. All surfels are in a temporary file in options.scratch. Errors: usage (options, CRS);
/// bad_input: no IMU or lidar data, a spinner that does not turn, too short a drive, a trajectory that the data do not
/// determine or that contradicts GPS or itself; whatever `read` returns; interrupted.
Result<SlamResult> run_slam(const LogReader& read, const Rig& rig, const std::string& crs, const SlamOptions& options,
                            Progress& progress);

}  // namespace rayfield::slam
