#pragma once

#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/slam/options.h"     // SlamOptions: everything that can be set
#include "rayfield/slam/plan_view.h"   // plan_grid(): a picture of a drive from above
#include "rayfield/slam/report.h"      // SlamReport: accuracy, residuals, warnings; as JSON and as a summary
#include "rayfield/slam/trajectory.h"  // Trajectory: the path of the IMU in the map frame
#include "rayfield/slam/unwarp.h"      // open_unwarped(): log + trajectory → rays

/// From the log of a drive to its trajectory, run_slam(), and from both to a ray cloud, open_unwarped():
///
///   pass 1  log ─▶ lidar points in the IMU frame ─▶ sliding window: IMU integration, surfels, non-rigid registration
///           ─▶ levelled and aligned with GPS ─▶ global registration with loop closures ─▶ GPS released ─▶ map frame
///   pass 2  log + trajectory ─▶ rays, streamed
///
/// Frames: IMU (the rig's reference), world (levelled, arbitrary yaw), ENU (east, north, up at the median fix), map
/// (projected CRS). Same log, rig and options give the same trajectory to the last bit at any number of threads. The
/// method and its accuracy are described in docs/slam.md.
namespace rayfield::slam {

/// A fix in map coordinates, for plots.
struct GpsMark {
  double time_s = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  bool outlier = false;
};

struct SlamResult {
  Trajectory trajectory;
  SensorOffsets offsets;  ///< for open_unwarped()
  std::vector<GpsMark> gps;
  SlamReport report;
};

/// Reconstructs one drive. `crs`: a projected CRS, or empty for a local frame. Without usable GPS the frame is local
/// whatever `crs` says, and the report states it.
/// If the rig asks for offsets to be estimated the log is read twice: the first pass finds nine tenths of them.
/// Memory: the trajectory and its data (40 kB per second of driving), a few seconds of points, and the
/// surfels of a square of 32 m. All surfels are in a temporary file in options.scratch. Errors: usage (options, CRS);
/// bad_input: no IMU or lidar data, a spinner that does not turn, too short a drive, a trajectory that the data do not
/// determine or that contradicts GPS or itself; whatever `read` returns; interrupted.
Result<SlamResult> run_slam(const LogReader& read, const Rig& rig, const std::string& crs, const SlamOptions& options,
                            Progress& progress);

}  // namespace rayfield::slam
