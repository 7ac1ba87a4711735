#pragma once

#include <gtest/gtest.h>

#include <string>

#include "rayfield/formats/log_info.h"
#include "tests/formats/bag_bytes.h"

/// A short drive with one of each sensor, and what can be wrong with it.
namespace rayfield::formats {

using namespace bytes;

struct Drive {
  const char* lidar_topic = "/horizontal/scan";
  bool spinner = true;
  double no_return = kInfinity;
  double gravity = 9.81;
  int gap_at = -1;      ///< second without IMU
  int jump_at = -1;     ///< second from which all stamps are an hour later
  int still_from = -1;  ///< second from which the spinner stands still for three seconds
  double rate = 0.1;    ///< of the gyroscope
};

/// 20 s: IMU at 50 Hz, scans at 5 Hz with a third of the beams without a return, GPS and joints at 5 Hz.
inline std::string drive_bag(const Drive& drive) {
  std::string records = connection(0, "/imu", kImuType, kImuMd5) + connection(1, "/fix", kFixType, kFixMd5) +
                        connection(2, "/joints", kJointType, kJointMd5) +
                        connection(3, drive.lidar_topic, kScanType, kScanMd5) +
                        connection(4, "/camera", "sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743");
  double angle = 0;
  for (int i = 0; i < 1000; ++i) {
    const bool jumped = drive.jump_at >= 0 && i / 50 >= drive.jump_at;
    const auto s = static_cast<std::uint32_t>(1000 + i / 50 + (jumped ? 3600 : 0));
    const auto ns = static_cast<std::uint32_t>(i % 50 * 20'000'000);
    if (i / 50 != drive.gap_at) records += message(0, s, ns, imu(s, ns, drive.rate, drive.gravity));
    if (i % 10 != 0) continue;
    if (drive.still_from < 0 || i < 50 * drive.still_from || i >= 50 * (drive.still_from + 3)) angle += 1.0;
    records += message(3, s, ns, scan(s, ns, {-1, 0.1, 1e-5, 0.05, 40}, {3.0, drive.no_return, 39.9}));
    records += message(1, s, ns, fix(s, ns, 0, -35.0 - 1e-5 * i, 138.5 + 1e-5 * i, 80 + 0.01 * i));
    records +=
        message(2, s, ns, joints(s, ns, {"wobble", "turntable"}, {0.001 * (i % 2), drive.spinner ? angle : 0.5}));
  }
  return bag_header() + chunk(records);
}

inline LogInfo inspect(const std::string& content) {
  const TemporaryFile file(content);
  const auto info = inspect_log(file.path());
  if (!info) ADD_FAILURE() << info.error().line();
  return info ? *info : LogInfo();
}

}  // namespace rayfield::formats
