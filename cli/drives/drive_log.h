#pragma once
/// drives: logs of a drive: registered, turned into rays, drawn.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/formats/sensor_log.h"
#include "rayfield/slam/slam.h"

namespace rayfield::cli {

/// A log that was registered: its trajectory, what the run says of itself, and its rays as a stream.
struct RegisteredDrive {
  std::shared_ptr<const slam::Trajectory> trajectory;
  slam::SlamReport report;  ///< empty for a trajectory that was given
  std::vector<slam::GpsMark> gps;
  std::optional<LidarBeam> beam;          ///< of the lidar, from the rig file and as measured in the drive
  std::vector<std::string> log_warnings;  ///< damage, clock jumps, late messages
  std::unique_ptr<RaySource> rays;
};

/// What a ray cloud that lies nowhere on Earth has in the place of its CRS.
inline constexpr const char* kLocalFrame = "local";

/// True for files that are logs rather than ray clouds: by their first bytes, or by their name (`.bag`, `.bag.active`,
/// and those of ROS 2, which the reader refuses with what to do).
bool is_log(const std::filesystem::path& path);

/// A log that was read once: its longest segment between clock jumps is bound, its sensors are known to be there.
struct OpenedLog {
  Rig rig;
  LogReader read;
  formats::LogReport report;  ///< of that segment
  std::vector<std::string> warnings;
};

/// Reads a log once. Warns of its damage, gaps and clock jumps at once, before the long work. Errors: those of
/// formats::read_rig() and formats::read_log(); usage where `crs` is not made for the place of the GPS fixes.
Result<OpenedLog> open_log(const std::string& log, const std::string& rig_file, const std::string& crs,
                           Progress& progress);

/// Runs SLAM over a log. `crs` empty: a local frame. A log without GPS gives a local frame too, or an error (bad_input)
/// where `require_gps`; fixes that cannot place the drive, of a vehicle that stood still, are one wherever a CRS was
/// asked for. `options.scratch`: a folder for what does not fit in memory.
Result<RegisteredDrive> register_drive(const std::string& log, const std::string& rig_file, const std::string& crs,
                                       bool require_gps, const slam::SlamOptions& options, Progress& progress);

/// The rays of a log along a trajectory from elsewhere (TUM text of the IMU frame in `crs`).
Result<RegisteredDrive> follow_trajectory(const std::string& log, const std::string& rig_file,
                                          const std::string& trajectory_file, const std::string& crs,
                                          Progress& progress);

/// Everything that a user should know of a registered drive, its rays included once they were read.
std::vector<std::string> all_warnings(const RegisteredDrive& drive);

}  // namespace rayfield::cli
