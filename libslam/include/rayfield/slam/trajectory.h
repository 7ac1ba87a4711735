#pragma once

#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/core/rigid3.h"

namespace rayfield::slam {

/// The path of the IMU. Positions are in the map frame (easting, northing, height, m), rotations bring IMU axes to grid
/// east, north and up. Times are Unix seconds on the IMU clock, strictly increasing.
struct Trajectory {
  std::vector<TimedPose> poses;
  std::string crs;              ///< "EPSG:7854"; empty: a local frame
  double horizontal_scale = 1;  ///< grid metres per metre on the ground, horizontally

  bool empty() const { return poses.empty(); }
  /// Pose at a time by interpolation between neighbours (linear, geodesic); false outside the trajectory or inside a
  /// gap longer than `max_gap_s`. `cursor` remembers the place of the last query: queries in order cost O(1).
  bool at(double time_s, Rigid3& map_from_imu, std::size_t& cursor, double max_gap_s = 0.25) const;
  double length_m() const;
};

/// A trajectory from poses in a projected CRS (or a local frame where `crs` is empty), with the CRS's scale factor at
/// its first pose. For trajectories from other software. Errors: usage (the CRS cannot be used), bad_input (fewer
/// than two poses, times not increasing, values not finite).
Result<Trajectory> make_trajectory(std::vector<TimedPose> poses, const std::string& crs);

}  // namespace rayfield::slam
