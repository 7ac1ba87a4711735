/// surfels: surfels and poles: how they are extracted from points, kept on disk, divided by place, and matched.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "libslam/trajectory/pose_track.h"
#include "rayfield/core/lidar_beam.h"
#include "rayfield/core/result.h"
#include "rayfield/slam/options.h"

namespace rayfield::slam {

/// A lidar hit in the IMU frame at its own time.
struct BodyPoint {
  double time_s = 0;  ///< after the epoch of the drive, on the IMU clock
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  float spin_rate_rad_s = 0;
};

/// A planar patch seen within one time bin. Position and normal are held in the IMU frame at `time_s` (the mean time of
/// its points) and move rigidly with the pose of that time: within a voxel and a bin the points span a few hundredths
/// of a second under a spinning lidar.
struct Surfel {
  double time_s = 0;
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  ///< mean of the points
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, towards the sensor
  float variance_m2 = 0;                             ///< smallest eigenvalue of the points' covariance
  float spin_rate_rad_s = 0;                         ///< of the spinner at `time_s`
  std::uint8_t level = 0;                            ///< index into SurfelOptions::voxel_size_m
};

/// Surfels and poles of one time bin, in the order of time.
struct Features {
  std::vector<Surfel>
      surfels;                ///< at most SurfelOptions::max_surfels_per_bin of each level, even over the bin's voxels
  std::vector<Surfel> poles;  ///< detections of poles, see detect_poles()
};

/// What points were measured with.
struct BeamSource {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< where the beams start, in the IMU frame, to a decimetre
  LidarBeam beam;                                    ///< thin where it is not known

  /// How far along the beam the spot reaches that it lights on a plane, m: its diameter times the tangent of the angle
  /// between beam and normal. `center`, `normal`: of the plane, IMU frame. Infinite where the beam runs in the plane.
  double spot_depth_m(const Eigen::Vector3d& center, const Eigen::Vector3d& normal) const;
};

/// Points are put into one frame with `track`, which must cover their times.
Features extract_features(std::span<const BodyPoint> points, const BeamSource& source, const PoseTrack& track,
                          const SurfelOptions& options, const PoleOptions& poles, int threads = 1);

}  // namespace rayfield::slam
