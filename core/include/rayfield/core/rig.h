#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "rayfield/core/lidar_beam.h"
#include "rayfield/core/rigid3.h"

namespace rayfield {

/// What a lidar writes for a beam without a return.
enum class NoReturn { infinity, zero, max_range };

/// The sensors of a vehicle and how they are mounted (the rig file of docs/rig.md).
struct Rig {
  struct Lidar {
    std::string topic = "/lidar/scan";
    double min_range_m = 0.2;
    double max_range_m = 40.0;
    NoReturn no_return = NoReturn::infinity;
    std::optional<LidarBeam> beam;  ///< absent: not known
  } lidar;
  struct Spinner {
    std::string topic = "/spinner/joint_states";
    std::string joint = "spinner";
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< in the spinner frame, unit
  };
  std::optional<Spinner> spinner;  ///< absent for a fixed lidar
  struct Imu {
    std::string topic = "/imu/data";
    double gyro_noise_rad_s_sqrt_hz = 3e-4;  ///< white noise density
    double accel_noise_m_s2_sqrt_hz = 3e-3;  ///< white noise density
    double gyro_bias_rad_s2_sqrt_hz = 1e-5;  ///< random walk density
    double accel_bias_m_s3_sqrt_hz = 1e-4;   ///< random walk density
  } imu;
  struct Gps {
    std::string topic = "/gps/fix";
  };
  std::optional<Gps> gps;  ///< absent: nothing is georeferenced

  Rigid3 imu_from_spinner;
  Rigid3 spinner_from_lidar;  ///< for a fixed lidar imu_from_spinner is the identity and this is imu_from_lidar
  Eigen::Vector3d imu_from_gps_m = Eigen::Vector3d::Zero();  ///< lever arm of the antenna in the IMU frame

  double lidar_offset_s = 0;  ///< added to lidar stamps to get IMU time
  double gps_offset_s = 0;    ///< added to GPS stamps to get IMU time
  bool estimate_lidar_offset = false;
  bool estimate_spinner_offset = false;
  bool estimate_gps_offset = false;
};

}  // namespace rayfield
