#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield {

/// One sample of an inertial measurement unit, in the IMU frame.
struct ImuSample {
  double time_s = 0;
  Eigen::Vector3d angular_velocity_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d linear_acceleration_m_s2 = Eigen::Vector3d::Zero();  ///< specific force: +9.81 up at rest
};

/// One position fix. Latitude and longitude in degrees, height above the ellipsoid in m.
struct GpsFix {
  double time_s = 0;
  double latitude_deg = 0, longitude_deg = 0, height_m = 0;
  Eigen::Matrix3d covariance_enu_m2 = Eigen::Matrix3d::Zero();
  int status = 0;           ///< sensor_msgs/NavSatStatus: -1 no fix, 0 fix, 1 SBAS, 2 GBAS
  int covariance_type = 0;  ///< 0 unknown, 1 approximated, 2 diagonal, 3 full
};

/// Angle of the spinner about its axis, rad, as the encoder gives it (wrapped or not).
struct SpinnerAngle {
  double time_s = 0;
  double angle_rad = 0;
};

/// An echo of a beam behind its first one.
struct LaterEcho {
  std::uint32_t point = 0;  ///< of the LidarScan: the beam's first echo
  float range_m = 0;
  float intensity = 0;
};

/// One message of a lidar as points in the lidar frame, each with its own time. Range values follow REP 117 after the
/// reader has applied the rig's convention: +inf nothing within range, -inf too close, NaN invalid.
struct LidarScan {
  double time_s = 0;                       ///< stamp of the message: time of its first point
  std::vector<Eigen::Vector3f> direction;  ///< unit vectors in the lidar frame
  std::vector<float> range_m;
  std::vector<float> time_offset_s;  ///< from time_s
  std::vector<float> intensity;      ///< empty where the log has none
  /// Of lidars that report several echoes of a beam: those behind the first, by point and range. Simulated drives have
  /// them and logs are written with them; what is read from a log has the first echoes alone.
  std::vector<LaterEcho> later;
};

/// Receives the messages of a log, in the order of the log.
class SensorSink {
 public:
  virtual ~SensorSink() = default;
  virtual void imu(const ImuSample&) {}
  virtual void gps(const GpsFix&) {}
  virtual void spinner(const SpinnerAngle&) {}
  virtual void lidar(const LidarScan&) {}
};

/// Reads a whole log into a sink; called once per pass. (formats::read_log() bound to a path and a rig.)
using LogReader = std::function<Result<void>(SensorSink&)>;

}  // namespace rayfield
