#include "libslam/pipeline/spot_depth.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "libslam/global_registration/global_registration.h"
#include "libslam/input/read_ahead.h"
#include "libslam/pipeline/log_odometry.h"
#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr double kWide_m = 0.02, kWideRange_m = 5;  // beams that are worth a look at the log before the run
constexpr double kDefaultLimit_m = 0.15;            // that of a pulse of 1 ns; hardly a lidar resolves less
// By this much what is measured was too large on simulated drives (0.17 to 0.18 for 0.15 m, 0.07 for 0.05, 0.40 for
// 0.40), lifts of a millimetre or two among them.
constexpr double kUnnoticed_m = 0.022;
constexpr double kMaxRelativeSigma = 0.5;  // of a resolution that is believed
constexpr double kFirst_s = 60;

// Hands on what a lidar and its companions say until a minute after the lidar's first message.
class FirstMinute : public SensorSink {
 public:
  explicit FirstMinute(SensorSink& sink) : sink_(sink) {}
  void imu(const ImuSample& sample) override {
    if (!over_) sink_.imu(sample);
  }
  void gps(const GpsFix& fix) override {
    if (!over_) sink_.gps(fix);
  }
  void spinner(const SpinnerAngle& angle) override {
    if (!over_) sink_.spinner(angle);
  }
  void lidar(const LidarScan& scan) override {
    if (!first_s_) first_s_ = scan.time_s;
    over_ = over_ || scan.time_s > *first_s_ + kFirst_s;
    if (!over_) sink_.lidar(scan);
  }

 private:
  SensorSink& sink_;
  std::optional<double> first_s_;
  bool over_ = false;
};

// Windows of five seconds bend to where early echoes put the ground; the whole minute does not.
Result<std::optional<RangeResolution>> measure(LogOdometry& input, const Rig& rig, const SlamOptions& options,
                                               Progress& progress) {
  RAYFIELD_ASSIGN(LogSection section, input.finish());
  OdometryResult& odometry = section.odometry;
  RAYFIELD_CHECK(register_globally(odometry, *section.imu, {}, rig, options, progress));
  return measure_range_resolution(odometry.surfels, odometry.track, odometry.source, options.surfels.voxel_size_m);
}

}  // namespace

Result<SpotDepth> choose_spot_depth(const LogReader& read, const Rig& rig, const SlamOptions& options,
                                    Progress& progress) {
  SpotDepth out;
  out.limit_m = options.surfels.max_spot_depth_m;
  if (out.limit_m > 0 || !rig.lidar.beam) return out;
  out.limit_m = rig.lidar.beam->range_resolution_m.value_or(kDefaultLimit_m);
  if (rig.lidar.beam->range_resolution_m || rig.lidar.beam->diameter_at(kWideRange_m) < kWide_m) return out;
  // Only the first echo of a deep spot lies nearer than its middle: of the strongest it would be measured too large.
  if (rig.lidar.beam->returns.value_or(ReturnMode::first) != ReturnMode::first) return out;
  const auto start = std::chrono::steady_clock::now();
  SlamOptions unlimited = options;
  unlimited.surfels.max_spot_depth_m = std::numeric_limits<double>::infinity();
  progress.stage("range resolution", 0, "scans");
  LogOdometry input(rig, {}, unlimited, progress);
  FirstMinute first(input);
  RAYFIELD_CHECK(read_ahead(read, first, thread_count(options.threads)));
  Result<std::optional<RangeResolution>> measured = measure(input, rig, unlimited, progress);
  if (!measured && measured.error().code == ErrorCode::bad_input) return out;  // the run itself will say what is wrong
  if (!measured) return tl::make_unexpected(measured.error());
  if (*measured) out.measured = believed(**measured, kUnnoticed_m, kMaxRelativeSigma);
  if (out.measured) out.limit_m = out.measured->value_m;
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return out;
}

void note_spot_depth(const Rig& rig, const SpotDepth& spots, SlamReport& report) {
  if (!rig.lidar.beam) return;
  report.max_spot_depth_m = spots.limit_m;
  if (!spots.measured) return;
  report.range_resolution_m = spots.measured->value_m, report.range_resolution_sigma_m = spots.measured->sigma_m;
  const double duration = report.end_s - report.start_s;
  report.stages.insert(report.stages.begin(), StageTime{"range resolution of the beam", spots.seconds,
                                                        duration / std::max(spots.seconds, 1e-9)});
}

}  // namespace rayfield::slam
