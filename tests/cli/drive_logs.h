#pragma once

#include <functional>
#include <string>

#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "tests/cli/program.h"

namespace rayfield::test {

/// A simulated drive of some 50 s past two short rows: `<folder>/drive/2021-07-01/{scan.bag,rig.toml}`. Empty where the
/// simulation failed.
struct SimulatedLog {
  std::string bag, rig;
};
/// `lidar`: keys of the site's [lidar].
SimulatedLog simulate_drive(const Folder& folder, const std::string& lidar = {});

/// What to do to each message of a log on its way into a damaged copy: change it, or return false to leave it out.
/// `elapsed_s`: its stamp after the first of the log.
struct Damage {
  std::function<bool(ImuSample&, double elapsed_s)> imu;
  std::function<bool(GpsFix&, double elapsed_s)> gps;
  std::function<bool(SpinnerAngle&, double elapsed_s)> spinner;
  std::function<bool(LidarScan&, double elapsed_s)> lidar;
};

/// Every stamp of the log as `stamp` gives it.
Damage other_stamps(const std::function<double(double time_s, double elapsed_s)>& stamp);

/// Writes the damaged copy of a log of LaserScans. Returns `to`.
std::string write_damaged(const SimulatedLog& from, const std::string& to, const Damage& damage);

/// A bag with one topic of a sensor's raw packets.
std::string write_raw_packets(const std::string& to);

}  // namespace rayfield::test
