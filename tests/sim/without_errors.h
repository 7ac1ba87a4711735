#pragma once

#include "rayfield/sim/site.h"

namespace rayfield::sim {

/// The site with every sensor error switched off: range, encoder, IMU and GPS noise and biases, drop-outs,
/// disturbances, outages and time errors. Drive and scene stay.
inline Site without_errors(Site site) {
  site.lidar.range_noise_m = site.lidar.dropout_fraction = 0;
  site.disturbance = SiteDisturbance();
  site.spinning.encoder_noise_rad = 0;
  site.gps.noise_horizontal_m = site.gps.noise_vertical_m = 0;
  site.gps.bias_horizontal_m = site.gps.bias_vertical_m = 0;
  SiteImu& imu = site.imu;
  imu.gyro_noise_rad_s_sqrt_hz = imu.accel_noise_m_s2_sqrt_hz = imu.gyro_bias_rad_s = imu.accel_bias_m_s2 = 0;
  imu.gyro_bias_walk_rad_s2_sqrt_hz = imu.accel_bias_walk_m_s3_sqrt_hz = 0;
  for (SiteDate& date : site.dates) {
    date.lidar_time_error_s = date.gps_time_error_s = date.spinner_angle_error_rad = 0;
    date.gps_outages.clear(), date.gps_jumps.clear();
  }
  return site;
}

}  // namespace rayfield::sim
