#pragma once

#include <vector>

#include "cli/drives/drive_log.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/add_options.h"

namespace rayfield::cli {

/// Adds the files of a drive that are kept with its scan: `slam.json`, the report without its timings (equal logs give
/// equal bytes), and `trajectory.tum.bz2`, the path of the IMU as SLAM found it. The second log of a scan gives
/// `slam_2.json` and `trajectory_2.tum.bz2`.
Result<void> keep_drive_files(const RegisteredDrive& drive, std::vector<tile::NewAttachment>& files);

}  // namespace rayfield::cli
