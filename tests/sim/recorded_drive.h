#pragma once

#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {

/// A simulated drive with all that came out of it.
class RecordedDrive : public SensorSink {
 public:
  struct Options {
    bool rays = true;
    int threads = 2;
  };
  explicit RecordedDrive(const Site& site, Options options) : world(make_world(site)), drive(take(plan_drive(world))) {
    Progress progress;
    RayCallback callback;
    if (options.rays)
      callback = [this](const RayBatch& batch) -> Result<void> {
        for (std::size_t i = 0; i < batch.size(); ++i)
          rays.push(batch.origin[i], batch.end[i], batch.time_s[i], batch.intensity[i], batch.hit[i] != 0);
        return {};
      };
    summary = take(simulate(world, drive, *this, callback, {options.threads}, progress));
  }
  explicit RecordedDrive(const Site& site) : RecordedDrive(site, Options()) {}

  void imu(const ImuSample& sample) override { imu_samples.push_back(sample), note(sample.time_s); }
  void gps(const GpsFix& fix) override { fixes.push_back(fix), note(fix.time_s); }
  void spinner(const SpinnerAngle& angle) override { angles.push_back(angle), note(angle.time_s); }
  void lidar(const LidarScan& scan) override { scans.push_back(scan), note(scan.time_s); }

  World world;
  Drive drive;
  SimulationSummary summary;
  std::vector<ImuSample> imu_samples;
  std::vector<GpsFix> fixes;
  std::vector<SpinnerAngle> angles;
  std::vector<LidarScan> scans;
  RayBatch rays;
  bool in_order = true;

 private:
  double last_ = 0;
  void note(double time_s) {
    in_order = in_order && time_s >= last_;
    last_ = time_s;
  }
};

}  // namespace rayfield::sim
