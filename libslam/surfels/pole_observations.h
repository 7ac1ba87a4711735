#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "libslam/surfels/surfel.h"
#include "libslam/trajectory/pose_track.h"
#include "rayfield/slam/options.h"

/// Posts and trunks as landmarks. Each lane sees only one side of them, so what lanes have in common is not a surface
/// but an axis: it lies behind the visible surface by a depth that is about the same for the poles of a site and is
/// estimated with the trajectory; its variation from pole to pole counts as an error of the distance between opposite
/// sides. Ground constrains lanes across the rows only where it is uneven; poles constrain them everywhere.
namespace rayfield::slam {

/// A slice of a pole as seen in one pass. Position and view are held in the IMU frame at `time_s`.
struct PoleObservation {
  /// When the vehicle is abreast of the pole. A pole seen ahead or behind would constrain the distance along the lane,
  /// far less accurately than the surfels do: 0.6 mm of depth at 2 m ahead are 0.03 % of the length of all lanes.
  double time_s = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< mean of the detections, m
  Eigen::Vector3d view =
      Eigen::Vector3d::Zero();  ///< mean direction from the sensor, horizontal in the world, ≤ 1 long
  float spin_rate_rad_s = 0;    ///< of the spinner, mean
  int detections = 0;
};

/// Groups detections (detect_poles(), in the order of time), placed with `track`: those of one slice of height, less
/// than options.gather_m apart in plan and options.max_pause_s in time. `depth_m`: from the visible surface to the
/// axis.
std::vector<PoleObservation> gather_observations(std::span<const Surfel> detections, const PoseTrack& track,
                                                 double depth_m, const PoleOptions& options);

/// Two observations of one slice of a pole: indices, first < second.
struct PolePair {
  std::uint32_t first = 0, second = 0;
  double observations = 2;  ///< how many observations the slice has
  double depth_m = 0;       ///< from the visible surface to the axis of this pole, by itself
  double variance_m2 = 0;   ///< of the offset between the two axes, in either direction
  /// Unit, horizontal in the world: along it the two observations look from different sides.
  Eigen::Vector3d sides = Eigen::Vector3d::UnitX();
  double thickness_variance_m2 = 0;  ///< of the offset along `sides`, besides, if the common depth is used
};

/// Which observations are paired.
struct PoleQuery {
  double reach_m = 0.1;                    ///< horizontal distance of the axes
  double min_gap_s = 10, max_gap_s = 1e9;  ///< |time difference| in [min, max)
};

/// Pairs in the order of `first`. `depth_m`: common to all poles.
std::vector<PolePair> pair_observations(std::span<const PoleObservation> observations, const PoseTrack& track,
                                        double depth_m, const PoleQuery& query, const PoleOptions& options);

}  // namespace rayfield::slam
