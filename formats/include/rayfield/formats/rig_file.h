#pragma once

/// vehicle: the text files of a vehicle, its rig and its trajectory.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"

/// The rig file (docs/rig.md): TOML with the tables lidar, spinner, imu, gps, extrinsics and time.
namespace rayfield::formats {

/// Reads and checks a rig file. Unknown keys are refused; quaternions and axes must be unit within 1e-3 and are
/// normalised. Errors: usage with the line in `where` (syntax, unknown or missing keys, values out of range),
/// bad_input or resources where the file cannot be read.
Result<Rig> read_rig(const std::string& path);

/// The same for text already in memory; `name` stands for the path in messages.
Result<Rig> parse_rig(std::string_view text, const std::string& name);

/// Only the lidar's beam, which is all that a ray cloud needs; other tables than [lidar] are not looked at. Absent if
/// the file does not state it. Errors: as read_rig().
Result<std::optional<LidarBeam>> read_rig_beam(const std::string& path);

/// How a lidar is mounted whose points were georeferenced by other software.
struct RigMounting {
  std::optional<Eigen::Vector3d> lidar_in_imu_m;  ///< absent where the file has no [extrinsics]
  double lidar_offset_s = 0;                      ///< added to the lidar's times to get those of the IMU
};

/// The lidar in the IMU frame, m. On a spinner, whose angle no point knows, the centre of the circle on which it goes
/// about the axis: each ray begins up to the circle's radius beside it.
Eigen::Vector3d mean_lidar_in_imu_m(const Rig& rig);

/// Only the tables [spinner], [extrinsics] and [time], which is all that points with a trajectory need. Errors: as
/// read_rig().
Result<RigMounting> read_rig_mounting(const std::string& path);

/// The rig as a rig file; parse_rig() of it gives the same rig.
std::string rig_text(const Rig& rig);

Result<void> write_rig(const std::string& path, const Rig& rig);

/// Checks ranges and units of a rig, wherever it comes from. Errors: usage.
Result<void> validate_rig(const Rig& rig);

}  // namespace rayfield::formats
