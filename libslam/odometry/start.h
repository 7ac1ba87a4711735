#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "libslam/input/imu_grid.h"

namespace rayfield::slam {

/// First guess of a drive from its first seconds.
struct StartGuess {
  double stationary_s = 0;
  Eigen::Quaterniond level_from_imu = Eigen::Quaterniond::Identity();  ///< roll and pitch only
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  double gyro_bias_sigma = 0.02;
  double tilt_sigma_rad = 0.05;
};

/// White noise densities seen in the data: rad/s/√Hz and m/s²/√Hz.
struct WhiteNoise {
  double gyro_density = 0, accel_density = 0;
};

/// From fourth differences, whose variance is 70 σ² for white noise of σ per sample, and which suppress motion of
/// frequency f by (2 sin πf·dt)⁴: 1e-3 for the bounce of a vehicle (3 Hz) at 100 Hz. Median of the three axes, each by
/// its median absolute difference.
WhiteNoise measure_white_noise(const ImuGrid& imu);

/// Finds the stationary start (blocks of half a second whose rates are small and steady) and takes roll, pitch and the
/// gyro bias from it; without one, roll and pitch from the mean specific force of `samples`.
StartGuess guess_start(const ImuGrid& imu, int samples);

}  // namespace rayfield::slam
