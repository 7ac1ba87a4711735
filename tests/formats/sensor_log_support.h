#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "rayfield/formats/sensor_log.h"
#include "tests/formats/bag_bytes.h"

/// What the tests of the sensor log share.
namespace rayfield::formats {

using namespace bytes;

struct Collected : SensorSink {
  std::vector<ImuSample> imus;
  std::vector<GpsFix> fixes;
  std::vector<SpinnerAngle> angles;
  std::vector<LidarScan> scans;
  std::string order;
  void imu(const ImuSample& sample) override { imus.push_back(sample), order += 'i'; }
  void gps(const GpsFix& fix) override { fixes.push_back(fix), order += 'g'; }
  void spinner(const SpinnerAngle& angle) override { angles.push_back(angle), order += 's'; }
  void lidar(const LidarScan& scan) override { scans.push_back(scan), order += 'l'; }
};

inline std::string connections(const char* lidar_type = kScanType, const char* lidar_md5 = kScanMd5) {
  return connection(0, "/imu/data", kImuType, kImuMd5) + connection(1, "/gps/fix", kFixType, kFixMd5) +
         connection(2, "/spinner/joint_states", kJointType, kJointMd5) +
         connection(3, "/lidar/scan", lidar_type, lidar_md5);
}

inline Rig full_rig() {
  Rig rig;
  rig.spinner = Rig::Spinner();
  rig.gps = Rig::Gps();
  return rig;
}

inline Rig lidar_rig() { return Rig(); }

inline LogOptions any_sensors() {
  LogOptions options;
  options.require_imu = false;
  options.require_lidar = false;
  return options;
}

inline Result<LogReport> read(const std::string& records, const Rig& rig, SensorSink& sink,
                              const LogOptions& options = {}) {
  const TemporaryFile file(bag_header() + chunk(records));
  return read_log(file.path(), rig, sink, options);
}

inline std::string imu_at(double seconds, double record_s) {
  const auto split = [](double t) { return std::pair(std::floor(t), std::round((t - std::floor(t)) * 1e9)); };
  const auto [stamp_s, stamp_ns] = split(seconds);
  const auto [log_s, log_ns] = split(record_s);
  return message(0, static_cast<std::uint32_t>(log_s), static_cast<std::uint32_t>(log_ns),
                 imu(static_cast<std::uint32_t>(stamp_s), static_cast<std::uint32_t>(stamp_ns)));
}
inline std::string imu_at(double seconds) { return imu_at(seconds, seconds); }

inline std::vector<double> times_of(const Collected& got) {
  std::vector<double> times;
  for (const ImuSample& sample : got.imus) times.push_back(sample.time_s);
  return times;
}

}  // namespace rayfield::formats
