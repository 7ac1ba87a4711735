/// global_registration: stage b: global registration of the whole drive with loop closures, poles and GPS.
#pragma once

#include <span>
#include <vector>

#include "libslam/global_registration/revisit_statistics.h"
#include "libslam/gps/gps_alignment.h"
#include "libslam/input/imu_grid.h"
#include "libslam/odometry/odometry.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/slam/options.h"
#include "rayfield/slam/report.h"

namespace rayfield::slam {

/// Uncertainty of the pose at a time.
struct PoseUncertainty {
  double time_s = 0;
  Matrix6d covariance = Matrix6d::Zero();  ///< translation (m), rotation (rad); in the world, rotation on the left
};

/// Statistics of the global registration.
struct RegistrationStats {
  ResidualSummary near_surfels, revisit_surfels, gps_m, gyro_rad_s, accel_m_s2;
  ResidualSummary poles;    ///< between the axes of pairs of observations, m
  double pole_depth_m = 0;  ///< from the visible surface of posts and trunks to their axes
  double thickness_m = 0;   ///< robust standard deviation of one flat surface seen in different passes
  std::uint64_t thickness_count = 0;
  std::uint64_t linked_sections = 0;  ///< pairs of 5 s sections that at least ten revisits link
  RevisitMisfit revisits;
  double release_shift_mean_m = 0, release_shift_max_m = 0;  ///< motion of the poses when GPS was released
  Eigen::Vector2d offsets = Eigen::Vector2d::Zero();         ///< estimated lidar (s) and spinner (rad) offsets
  Eigen::Vector2d offset_sigmas = Eigen::Vector2d::Zero();
  std::vector<PoseUncertainty> uncertainty;  ///< relative to the pose in the middle of the drive
  double imu_misfit = 0, imu_misfit_s = 0;   ///< largest over sections of five seconds, standard deviations; its time
  double last_correction_m = 0;  ///< largest move of a knot in the last iteration, less the motion of the whole
};

/// Stage b: corrects odometry.track over the whole drive (docs/slam.md, "Stage b: the whole drive"). On entry and on
/// return the track is in the frame of the fixes (z up, aligned with GPS). `fixes` may be empty: then a weak prior
/// holds the gauge. Surfels and biases in `odometry` are updated too. Errors: bad_input (singular), interrupted.
Result<RegistrationStats> register_globally(OdometryResult& odometry, const ImuGrid& imu,
                                            std::span<const GpsPosition> fixes, const Rig& rig,
                                            const SlamOptions& options, Progress& progress);

}  // namespace rayfield::slam
