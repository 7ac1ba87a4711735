#pragma once

#include <span>
#include <vector>

#include "libslam/global/visits.h"
#include "libslam/gps/gps_alignment.h"
#include "libslam/input/imu_grid.h"
#include "libslam/odometry/odometry.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rig.h"
#include "rayfield/slam/options.h"

namespace rayfield::slam {

/// Figures of the residuals of one kind.
struct ResidualStats {
  std::uint64_t count = 0;
  double rms = 0;  ///< weighted by the final robust weights
};

/// Uncertainty of the pose at a time.
struct PoseUncertainty {
  double time_s = 0;
  Matrix6d covariance = Matrix6d::Zero();  ///< translation (m), rotation (rad); in the world, rotation on the left
};

/// What the global stage says of itself.
struct GlobalStats {
  ResidualStats near_surfels, revisit_surfels, gps_m, gyro_rad_s, accel_m_s2;
  ResidualStats poles;      ///< between visits, m
  double pole_depth_m = 0;  ///< from the visible surface of posts and trunks to their axes
  double thickness_m = 0;   ///< spread of one flat surface seen at different visits (robust standard deviation)
  std::uint64_t thickness_count = 0;
  std::uint64_t linked_visits = 0;  ///< pairs of 5 s stretches that at least ten revisit matches link
  VisitMisfit visits;
  double release_shift_mean_m = 0, release_shift_max_m = 0;  ///< motion of the poses when GPS was released
  Eigen::Vector2d offsets = Eigen::Vector2d::Zero();         ///< estimated lidar (s) and spinner (rad) offsets
  Eigen::Vector2d offset_sigmas = Eigen::Vector2d::Zero();
  std::vector<PoseUncertainty> uncertainty;  ///< relative to the pose in the middle of the drive
  double imu_misfit = 0, imu_misfit_s = 0;   ///< largest over stretches of five seconds, standard deviations; its time
  int iterations = 0;
  double last_correction_m = 0;  ///< largest move of a knot in the last iteration, less the motion of the whole
  double matching_seconds = 0, solving_seconds = 0;
};

/// Stage b: corrects odometry.track over the whole drive (method: 2b). On entry the track stands in the frame of the
/// fixes (gravity along z, H applied); on return it still does. `fixes` may be empty: then a weak prior holds the
/// gauge. Surfels and biases in `odometry` are updated too. Errors: bad_input (singular), interrupted.
Result<GlobalStats> register_globally(OdometryResult& odometry, const ImuGrid& imu, std::span<const GpsPosition> fixes,
                                      const Rig& rig, const SlamOptions& options, Progress& progress);

}  // namespace rayfield::slam
