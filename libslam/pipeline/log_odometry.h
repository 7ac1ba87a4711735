/// pipeline: the whole chain from a log to trajectory and report, with the checks that a result has to pass.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/input/imu_grid.h"
#include "libslam/input/lidar_assembler.h"
#include "libslam/input/spike_filter.h"
#include "libslam/odometry/odometry.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/slam/unwarp.h"

namespace rayfield::slam {

/// An uninterrupted section of a log after stage a.
struct LogSection {
  OdometryResult odometry;
  std::optional<ImuGrid> imu;
  AssemblerCounts lidar;
};

/// Runs stage a while a log is being read, and keeps all fixes. A gap in the IMU's stamps longer than
/// options.max_imu_gap_s, or a step back by more than a second, ends a section of the log and begins another; the
/// longest one is kept.
class LogOdometry : public SensorSink {
 public:
  /// `known`: offsets that come on top of the rig's.
  LogOdometry(const Rig& rig, const SensorOffsets& known, const SlamOptions& options, Progress& progress);

  void imu(const ImuSample& sample) override;
  void gps(const GpsFix& fix) override;
  void spinner(const SpinnerAngle& angle) override;
  void lidar(const LidarScan& scan) override;

  /// The longest section. Errors: bad_input that says which sensor is missing or unusable, interrupted.
  Result<LogSection> finish();

  const std::vector<GpsFix>& fixes() const { return fixes_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void accept(const ImuSample& sample);
  void use(const ImuSample& sample);
  void drain(bool flush);
  void end_section();
  tl::unexpected<Error> no_section() const;
  std::unique_ptr<LidarAssembler> new_assembler() const;

  Rig rig_;
  SensorOffsets known_;
  SlamOptions options_;
  Progress& progress_;
  std::unique_ptr<LidarAssembler> assembler_;
  std::unique_ptr<Odometry> odometry_;
  std::optional<ImuSample> last_imu_, suspect_;  // the newest accepted; one whose stamp does not follow it
  SpikeFilter spikes_;
  std::optional<double> first_lidar_s_;
  std::optional<LogSection> best_;
  std::optional<Error> error_;
  std::vector<GpsFix> fixes_;
  std::optional<TangentPlane> first_plane_;
  std::vector<std::string> warnings_;
  std::uint64_t imu_count_ = 0, imu_invalid_ = 0, imu_late_ = 0, imu_stray_ = 0, angles_ = 0, scans_ = 0;
  std::uint64_t points_ = 0, hits_ = 0;
  double dropped_s_ = 0;
  double accel_sum_ = 0;
  int sections_ = 0;
};

}  // namespace rayfield::slam
