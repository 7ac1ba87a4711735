#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "imu_grid.h"

namespace rayfield::slam {

/// First guess of a drive from its first seconds.
struct StartGuess {
  double stationary_s = 0;
  Eigen::Quaterniond level_from_imu = Eigen::Quaterniond::Identity();  ///< roll and pitch only
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  double gyro_bias_sigma = 0.02;
  double tilt_sigma_rad = 0.05;
};

/// Finds the stationary start (blocks of half a second whose rates are small and steady) and takes roll, pitch and the
/// gyro bias from it; without one, roll and pitch from the mean specific force of `samples`.
StartGuess guess_start(const ImuGrid& imu, int samples);

}  // namespace rayfield::slam
