#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "libslam/input/imu_grid.h"

namespace rayfield::slam {

/// Initial state of a drive from its first seconds.
struct Initialization {
  double stationary_s = 0;
  Eigen::Quaterniond level_from_imu = Eigen::Quaterniond::Identity();  ///< roll and pitch only
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  double gyro_bias_sigma = 0.02;
  double tilt_sigma_rad = 0.05;
};

/// White noise densities of the data: rad/s/√Hz and m/s²/√Hz.
struct WhiteNoise {
  double gyro_density = 0, accel_density = 0;
};

/// From fourth differences, whose variance is 70 σ² for white noise of σ per sample, and which suppress motion of
/// frequency f by (2 sin πf·dt)⁴: 1e-3 for the bounce of a vehicle (3 Hz) at 100 Hz. Median of the three axes, each by
/// its median absolute difference.
WhiteNoise measure_white_noise(const ImuGrid& imu);

/// Finds how long the vehicle stands still at first (blocks of half a second whose rates are small and steady) and
/// takes roll, pitch and the gyro bias from that time; if it is in motion, roll and pitch come from the mean specific
/// force of the first `samples`.
Initialization find_initialization(const ImuGrid& imu, int samples);

}  // namespace rayfield::slam
