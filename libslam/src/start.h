#pragma once

#include <Eigen/Core>
#include <span>

#include "imu_grid.h"
#include "odometry.h"
#include "rayfield/slam/options.h"

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

/// Velocity of a drive that did not start at rest, m/s in the levelled frame of the track: of a grid of velocities in the
/// plane of the vehicle, up to `max_speed`, the one under which points above the ground seen in the first 1.5 s are seen
/// at the same places 2 s later (a spinner's period). `track` holds the vehicle's motion over at least 3.5 s up to a
/// constant velocity, which is added to it.
Eigen::Vector3d search_velocity(std::span<const BodyPoint> points, const PoseTrack& track, double max_speed, int threads);

}  // namespace rayfield::slam
