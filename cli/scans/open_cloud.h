#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/scans/add_scan.h"
#include "rayfield/core/lidar_beam.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/rig_file.h"
#include "rayfield/formats/trajectory_file.h"

namespace rayfield::cli {

/// True for files that are LAS or LAZ: by their first bytes, or by their name.
bool is_las(const std::filesystem::path& path);

/// LAS clouds need a trajectory, and nothing else takes one. Errors: usage, naming the file.
Result<void> check_trajectory_given(const ScanInputs& inputs);

/// What LAS clouds are read with.
struct CloudTrajectory {
  std::shared_ptr<const formats::TrajectoryFile> poses;  ///< nothing where none was given
  formats::RigMounting mounting;
  std::vector<std::string> warnings;

  /// Memory that it takes as long as rays are read.
  std::uint64_t bytes() const;
};

/// Reads the trajectory and the mounting in the rig file, where they were given. Of `memory_bytes` poses may take a
/// fourth. Errors: usage (another CRS than `crs`), those of reading.
Result<CloudTrajectory> read_cloud_trajectory(const ScanInputs& inputs, const std::string& crs,
                                              std::uint64_t memory_bytes, Progress& progress);

/// A ray cloud that was opened, whatever its format.
struct OpenedCloud {
  std::unique_ptr<RaySource> rays;
  std::optional<LidarBeam> beam;   ///< as the cloud's header states it
  std::vector<std::string> notes;  ///< what was assumed of its clock and its sensor's place
};

/// Opens a cloud and checks that it is in `crs` where it says so. Errors: bad_input (another CRS, a local frame), those
/// of formats::PlyReader and formats::LasReader.
Result<OpenedCloud> open_cloud(const std::filesystem::path& path, const ScanInputs& inputs, const std::string& crs,
                               const CloudTrajectory& trajectory, Progress& progress);

}  // namespace rayfield::cli
