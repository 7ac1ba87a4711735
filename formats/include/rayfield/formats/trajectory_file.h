#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/core/rigid3.h"

namespace rayfield::formats {

/// A trajectory as text. Either in the TUM format: lines `t x y z qx qy qz qw` with Unix time in s, position in the CRS
/// (easting, northing, height, m) and orientation of the body relative to grid east, north and up. Or as a table whose
/// first line names its columns (CSV, or what else separates them): time, x, y, z, and qx, qy, qz, qw where there are
/// orientations; others are passed over. Lines that begin with # or % are comments; `# crs: …` and `# frame: …` are
/// understood, and a first line of names may begin like a comment if the time comes first.
struct TrajectoryFile {
  std::vector<TimedPose> poses;  ///< times strictly increasing, in the file's own clock
  std::string crs;               ///< "EPSG:7854"; empty where the file names none
  std::string frame;             ///< the body, e.g. "IMU"; empty where the file names none
  bool has_orientation = true;   ///< false: a table without qx, qy, qz, qw; all rotations are the identity
};

struct TrajectoryReadOptions {
  /// A file with more poses is refused; a pose takes sizeof(TimedPose) of memory.
  std::size_t max_poses = std::numeric_limits<std::size_t>::max();
  /// Asked every 65 536 poses; true ends reading with ErrorCode::interrupted.
  std::function<bool()> cancelled = nullptr;
};

/// Reads such a text, or one that pack_trajectory() packed.
/// Errors: bad_input with the line in `where` (no pose, time not increasing, quaternion not unit within 1e-3, a table
/// without a column that is needed), resources (too many poses), interrupted.
Result<TrajectoryFile> read_trajectory(const std::string& path, const TrajectoryReadOptions& options = {});

/// Writes time to 0.1 µs, position to 1 µm and quaternions to 1e-10, through a temporary file that is renamed.
/// Errors: usage (a pose with NaN, times not increasing, line breaks in the names), resources.
Result<void> write_trajectory(const std::string& path, const TrajectoryFile& trajectory);

/// The same text as one bzip2 stream, to be kept: every pose, with time to 1 µs, position to 10 µm and quaternions to
/// 1e-8. Errors: as write_trajectory().
Result<std::string> pack_trajectory(const TrajectoryFile& trajectory);

}  // namespace rayfield::formats
