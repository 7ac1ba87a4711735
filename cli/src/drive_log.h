#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/slam/slam.h"

namespace rayfield::cli {

/// A log that was registered: its trajectory, what the run says of itself, and its rays as a stream.
struct RegisteredDrive {
  std::shared_ptr<const slam::Trajectory> trajectory;
  slam::SlamReport report;  ///< empty for a trajectory that was given
  std::vector<slam::GpsMark> gps;
  std::vector<std::string> log_warnings;  ///< damage, clock jumps, late messages
  std::unique_ptr<RaySource> rays;
};

/// True for the paths that are logs rather than ray clouds (`.bag`).
bool is_log(const std::filesystem::path& path);

/// Runs SLAM over a log. `crs` empty: a local frame.
Result<RegisteredDrive> register_drive(const std::string& log, const std::string& rig_file, const std::string& crs,
                                       int threads, Progress& progress);

/// The rays of a log along a trajectory from elsewhere (TUM text of the IMU frame in `crs`).
Result<RegisteredDrive> follow_trajectory(const std::string& log, const std::string& rig_file,
                                          const std::string& trajectory_file, const std::string& crs,
                                          Progress& progress);

}  // namespace rayfield::cli
