#pragma once

#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/core/rigid3.h"

namespace rayfield::formats {

/// A trajectory as text in the TUM format: lines `t x y z qx qy qz qw` with Unix time in s, position in the CRS
/// (easting, northing, height, m) and orientation of the body relative to grid east, north and up. Lines that begin
/// with # are comments; `# crs: …` and `# frame: …` are understood.
struct TrajectoryFile {
  std::vector<TimedPose> poses;  ///< times strictly increasing
  std::string crs;               ///< "EPSG:7854"; empty where the file names none
  std::string frame;             ///< the body, e.g. "IMU"; empty where the file names none
};

/// Reads such a text, or one that pack_trajectory() packed.
/// Errors: bad_input with the line in `where` (not eight numbers, time not increasing, quaternion not unit within
/// 1e-3), resources.
Result<TrajectoryFile> read_trajectory(const std::string& path);

/// Writes time to 0.1 µs, position to 1 µm and quaternions to 1e-10, through a temporary file that is renamed.
/// Errors: usage (a pose with NaN, times not increasing, line breaks in the names), resources.
Result<void> write_trajectory(const std::string& path, const TrajectoryFile& trajectory);

/// The same text as one bzip2 stream, to be kept: every pose, with time to 1 µs, position to 10 µm and quaternions to
/// 1e-8. Errors: as write_trajectory().
Result<std::string> pack_trajectory(const TrajectoryFile& trajectory);

}  // namespace rayfield::formats
