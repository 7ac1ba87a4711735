#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>

#include "rayfield/formats/trajectory_file.h"

namespace rayfield::formats {

/// Where the sensor was at any time of a trajectory.
class SensorPositions {
 public:
  enum class Place { found, outside, gap };

  /// `lever_arm_m`: the sensor in the frame of the trajectory's body; other than zero only where that has an
  /// orientation. Poses further apart than `max_gap_s` leave a gap between them. `trajectory`: at least one pose.
  SensorPositions(std::shared_ptr<const TrajectoryFile> trajectory, const Eigen::Vector3d& lever_arm_m,
                  double max_gap_s, double tolerance_s);

  /// The sensor's position in the map, between two poses linear in position and along the geodesic in orientation. Up
  /// to the tolerance beside a pose where the trajectory or a gap ends it is that of the pose. Queries in the order of
  /// time cost O(1).
  Place at(double time_s, Eigen::Vector3d& p_in_map);

 private:
  std::shared_ptr<const TrajectoryFile> trajectory_;
  Eigen::Vector3d lever_arm_m_;
  double max_gap_s_, tolerance_s_;
  std::size_t cursor_ = 0;  // of the pose before the last query
};

}  // namespace rayfield::formats
