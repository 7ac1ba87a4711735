#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "libslam/trajectory/so3.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/slam/trajectory.h"

/// An analytic world with exact sensors: a hall of 24 × 18 m with a level floor, four walls, two oblique partitions and
/// round columns, and a vehicle that stands still and then drives round it. No noise and no biases unless set.
namespace rayfield::slam::testing {

struct SceneOptions {
  double duration_s = 30;
  double rest_s = 6;  ///< standing still at first; 0: the log begins in motion
  double lidar_rate_hz = 100;
  int beams = 150;
  bool spins = true;  ///< false: a fixed lidar with 16 rings, 10 Hz
  Eigen::Vector3d gyro_bias = Eigen::Vector3d(0.002, -0.001, 0.003);
  Eigen::Vector3d accel_bias = Eigen::Vector3d(0.02, -0.03, 0.04);
  bool imu = true, lidar = true, gps = true, spinner = true;
  double spinner_rate_rad_s = std::numbers::pi;
  /// Called for each message before it is sent; false drops it. Times may be changed.
  std::function<bool(ImuSample&)> edit_imu;
  std::function<bool(LidarScan&)> edit_lidar;
  std::function<bool(GpsFix&)> edit_gps;
};

inline constexpr double kStart = 1.5e9;  // Unix s
inline const Eigen::Vector3d kSceneOrigin(-35.2, 138.5, 80);

inline Rig scene_rig(bool spins = true) {
  Rig rig;
  rig.gps = Rig::Gps{};
  rig.imu_from_gps_m = Eigen::Vector3d(-0.4, 0.1, 0.5);
  rig.lidar.max_range_m = 30;
  if (spins) {
    rig.spinner = Rig::Spinner{};
    rig.imu_from_spinner = {exp_so3({0.01, -0.02, 0.03}), {0.06, 0.0, 0.11}};
    // The scanner's plane stands upright: its x axis is horizontal, its y axis up.
    rig.spinner_from_lidar = {Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX())),
                              {0.035, 0, 0.02}};
  } else {
    rig.spinner_from_lidar = {exp_so3({0.02, 0.01, -0.04}), {0.1, 0, 0.15}};
  }
  return rig;
}

/// True pose (ENU from IMU) at t seconds after the start.
inline Rigid3 scene_pose(double t, double rest_s) {
  const double x = std::clamp((t - rest_s) / 3, 0.0, 1.0);
  // The turning rate rises smoothly from rest to 0.22 rad/s in three seconds; a drive in motion has it at once.
  double u = 0.22 * (3 * (x * x * x - 0.5 * x * x * x * x) + std::max(0.0, t - rest_s - 3));
  if (rest_s <= 0) u = 0.22 * t;
  Rigid3 pose;
  pose.translation = Eigen::Vector3d(7 * std::cos(u), 4.5 * std::sin(u), 1.7 + 0.02 * std::sin(3 * u));
  const double yaw = std::atan2(4.5 * std::cos(u), -7 * std::sin(u));
  pose.rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(0.02 * std::sin(4 * u), Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(0.03 * std::sin(5 * u), Eigen::Vector3d::UnitX());
  return pose;
}

/// Distance to the nearest surface.
inline double scene_range(const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
  double best = std::numeric_limits<double>::infinity();
  const auto plane = [&](const Eigen::Vector3d& n, double offset, auto&& inside) {
    const double speed = n.dot(d);
    const double s = (offset - n.dot(o)) / speed;
    if (std::abs(speed) > 1e-9 && s > 0 && s < best && inside(Eigen::Vector3d(o + s * d))) best = s;
  };
  const auto anywhere = [](const Eigen::Vector3d&) { return true; };
  const auto below_roof = [](const Eigen::Vector3d& p) { return p.z() < 4.0; };
  plane(Eigen::Vector3d::UnitZ(), 0, anywhere);
  plane(Eigen::Vector3d::UnitX(), 12, below_roof), plane(Eigen::Vector3d::UnitX(), -12, below_roof);
  plane(Eigen::Vector3d::UnitY(), 9, below_roof), plane(Eigen::Vector3d::UnitY(), -9, below_roof);
  const Eigen::Vector3d oblique(std::cos(0.5), std::sin(0.5), 0);
  plane(oblique, 1.0, [](const Eigen::Vector3d& p) { return p.z() < 2.5 && p.head<2>().norm() < 2.5; });
  plane(Eigen::Vector3d(-oblique.y(), oblique.x(), 0), -0.5,
        [](const Eigen::Vector3d& p) { return p.z() < 2.0 && p.head<2>().norm() < 2.0; });
  for (const auto& [cx, cy] : {std::pair(9.5, 6.5), std::pair(-9.0, 7.0), std::pair(-10.0, -6.0), std::pair(9.0, -7.0),
                               std::pair(3.5, 7.6), std::pair(-3.0, -7.4)}) {
    const Eigen::Vector2d m = o.head<2>() - Eigen::Vector2d(cx, cy);
    const double a = d.head<2>().squaredNorm(), b = m.dot(d.head<2>()), c = m.squaredNorm() - 0.4 * 0.4;
    const double root = b * b - a * c;
    if (a < 1e-12 || root < 0) continue;
    const double s = (-b - std::sqrt(root)) / a;
    if (s > 0 && s < best && (o + s * d).z() < 4.0) best = s;
  }
  return best;
}

inline ImuSample scene_imu(double t, const SceneOptions& options) {
  constexpr double kH = 1e-3;
  const Rigid3 before = scene_pose(t - kH, options.rest_s), now = scene_pose(t, options.rest_s),
               after = scene_pose(t + kH, options.rest_s);
  ImuSample s;
  s.time_s = kStart + t;
  s.angular_velocity_rad_s = log_so3(before.rotation.conjugate() * after.rotation) / (2 * kH) + options.gyro_bias;
  const Eigen::Vector3d a = (after.translation - 2 * now.translation + before.translation) / (kH * kH);
  s.linear_acceleration_m_s2 = now.rotation.conjugate() * (a + Eigen::Vector3d(0, 0, 9.80665)) + options.accel_bias;
  return s;
}

inline LidarScan scene_scan(double t, const Rig& rig, const SceneOptions& options) {
  LidarScan scan;
  scan.time_s = kStart + t;
  const int beams = options.spins ? options.beams : 16 * 180;
  for (int k = 0; k < beams; ++k) {
    Eigen::Vector3d d;
    double offset;
    if (options.spins) {
      const double angle = -1.65 + 3.3 * k / (beams - 1);
      d = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
      offset = k * 2e-5;
    } else {
      const double azimuth = 2 * std::numbers::pi * (k / 16) / 180, elevation = -0.35 + 0.7 * (k % 16) / 15;
      d = Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                          std::sin(elevation));
      offset = 0.1 * (k / 16) / 180;
    }
    const double at = t + offset;
    Rigid3 imu_from_lidar = rig.spinner_from_lidar;
    if (options.spins) {
      const Rigid3 turned{Eigen::Quaterniond(Eigen::AngleAxisd(options.spinner_rate_rad_s * at, rig.spinner->axis)),
                          Eigen::Vector3d::Zero()};
      imu_from_lidar = rig.imu_from_spinner * turned * rig.spinner_from_lidar;
    }
    const Rigid3 pose = scene_pose(at, options.rest_s) * imu_from_lidar;
    const double range = scene_range(pose.translation, pose.rotation * d);
    scan.direction.push_back(d.cast<float>());
    scan.range_m.push_back(range < rig.lidar.max_range_m ? static_cast<float>(range)
                                                         : std::numeric_limits<float>::infinity());
    scan.time_offset_s.push_back(static_cast<float>(offset));
  }
  return scan;
}

/// Sends the whole drive to `sink` in the order of time.
inline void feed_scene(SensorSink& sink, const Rig& rig, const SceneOptions& options) {
  const TangentPlane plane(kSceneOrigin);
  const int scan_every = static_cast<int>(std::lround(100 / (options.spins ? options.lidar_rate_hz : 10.0)));
  const int steps = static_cast<int>(std::lround(options.duration_s * 100));
  for (int k = 0; k <= steps; ++k) {
    const double t = 0.01 * k;
    ImuSample imu = scene_imu(t, options);
    if (options.imu && (!options.edit_imu || options.edit_imu(imu))) sink.imu(imu);
    if (options.spins && options.spinner)
      sink.spinner({kStart + t, std::remainder(options.spinner_rate_rad_s * t, 2 * std::numbers::pi)});
    if (k % 10 == 0 && options.gps) {
      const Eigen::Vector3d llh = plane.geodetic_from_enu(scene_pose(t, options.rest_s) * rig.imu_from_gps_m);
      GpsFix fix;
      fix.time_s = kStart + t, fix.latitude_deg = llh.x(), fix.longitude_deg = llh.y(), fix.height_m = llh.z();
      fix.covariance_enu_m2 = 0.25 * Eigen::Matrix3d::Identity(), fix.covariance_type = 2;
      if (!options.edit_gps || options.edit_gps(fix)) sink.gps(fix);
    }
    if (k % scan_every == 0 && options.lidar) {
      LidarScan scan = scene_scan(t, rig, options);
      if (!options.edit_lidar || options.edit_lidar(scan)) sink.lidar(scan);
    }
  }
}

/// A drive of the given length in the scene.
inline SceneOptions short_scene(double duration_s, double rest_s) {
  SceneOptions scene;
  scene.duration_s = duration_s, scene.rest_s = rest_s;
  return scene;
}

/// The true poses of such a drive.
inline Trajectory true_trajectory(double rest_s, double duration_s) {
  Trajectory t;
  for (int k = 0; k <= static_cast<int>(duration_s * 100); ++k)
    t.poses.push_back({kStart + 0.01 * k, scene_pose(0.01 * k, rest_s)});
  return t;
}

}  // namespace rayfield::slam::testing
