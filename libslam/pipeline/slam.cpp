#include "rayfield/slam/slam.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>

#include "libslam/global_registration/global_registration.h"
#include "libslam/gps/georeference.h"
#include "libslam/input/read_ahead.h"
#include "libslam/pipeline/log_odometry.h"
#include "libslam/pipeline/quality_check.h"
#include "libslam/pipeline/run_report.h"
#include "libslam/pipeline/spot_depth.h"
#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

class Clock {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// World → levelled world, by the mean of gravity as stage a estimated it.
Rigid3 level_from_world(const OdometryResult& odometry) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const InertialNode& node : odometry.inertial) up += node.state.gravity;
  return {Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()), Eigen::Vector3d::Zero()};
}

void transform_odometry(OdometryResult& odometry, const Rigid3& transform, Eigen::Quaterniond& total) {
  transform_track(odometry.track, transform);
  total = (transform.rotation * total).normalized();
}

Result<SlamResult> into_map(const LogSection& section, const GpsTrack& gps, const GpsAlignment& alignment,
                            const std::string& crs) {
  SlamResult out;
  const double epoch = section.odometry.epoch_s;
  if (!alignment.solved || crs.empty()) {
    out.trajectory = local_trajectory(section.odometry.track, epoch);
  } else {
    RAYFIELD_ASSIGN(const MapFrame frame, MapFrame::create(crs));
    out.trajectory = map_trajectory(section.odometry.track, epoch, *gps.plane, frame);
    for (const GpsPosition& p : gps.positions)
      out.gps.push_back({epoch + p.time_s, frame.map_from_geodetic(gps.plane->geodetic_from_enu(p.enu)), false});
  }
  if (alignment.solved && crs.empty())
    for (const GpsPosition& p : gps.positions) out.gps.push_back({epoch + p.time_s, p.enu, false});
  return out;
}

std::string frame_note(const GpsTrack& gps, const GpsAlignment& alignment, const Rig& rig, const std::string& crs,
                       const GpsOptions& options) {
  if (alignment.solved && crs.empty()) {
    const Eigen::Vector3d& o = gps.plane->origin();
    return fmt::format("local east-north-up frame at latitude {:.7f}, longitude {:.7f}, height {:.2f} m (no CRS given)",
                       o.x(), o.y(), o.z());
  }
  if (alignment.solved) return "yaw and position from GPS, roll and pitch from gravity";
  const std::string local = "local frame, nothing is georeferenced: ";
  if (!rig.gps) return local + "the rig has no GPS";
  if (gps.positions.empty()) return local + "the log has no usable GPS fix on " + rig.gps->topic;
  if (static_cast<int>(gps.positions.size()) < options.min_fixes)
    return local + fmt::format("only {} GPS fixes, {} are needed", gps.positions.size(), options.min_fixes);
  return local + fmt::format("the drive spans only {:.1f} m, {:.1f} m are needed to find its yaw", alignment.baseline_m,
                             options.min_baseline_m);
}

// One pass over the log, with sensors that are off by what is `known`. The quality of the result is checked in the
// `last` pass.
Result<SlamResult> reconstruct(const LogReader& read, const Rig& rig, const SensorOffsets& known, bool last,
                               const std::string& crs, const SlamOptions& options, Progress& progress) {
  Clock clock;

  // Stage a runs while the log is read.
  progress.stage("windowed registration", 0, "scans");
  LogOdometry input(rig, known, options, progress);
  RAYFIELD_CHECK(read_ahead(read, input, thread_count(options.threads)));
  RAYFIELD_ASSIGN(LogSection section, input.finish());
  const double window_seconds = clock.lap();

  // Into the frame of the fixes.
  OdometryResult& odometry = section.odometry;
  const double epoch = odometry.epoch_s, end = epoch + odometry.track.end_s();
  Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
  transform_odometry(odometry, level_from_world(odometry), turned);
  GpsTrack gps = rig.gps ? collect_fixes(input.fixes(), rig, epoch, end, epoch, options.gps) : GpsTrack{};
  GpsAlignment alignment = align_to_gps(odometry.track, gps.positions, rig.imu_from_gps_m, options.gps);
  if (alignment.solved) transform_odometry(odometry, alignment.enu_from_world, turned);
  GpsOffsetFit gps_offset;
  if (alignment.solved && rig.estimate_gps_offset) {
    gps_offset = fit_gps_offset(odometry.track, gps.positions, rig.imu_from_gps_m);
    for (GpsPosition& p : gps.positions) p.time_s += gps_offset.offset_s;
  }

  // Stage b: the whole drive at once.
  const std::span<const GpsPosition> fixes =
      alignment.solved ? std::span<const GpsPosition>(gps.positions) : std::span<const GpsPosition>();
  RAYFIELD_ASSIGN(const RegistrationStats stats,
                  register_globally(odometry, *section.imu, fixes, rig, options, progress));
  if (alignment.solved) {
    // The shape now comes from the lidar; yaw and position are fitted to all fixes once more.
    alignment = align_to_gps(odometry.track, gps.positions, rig.imu_from_gps_m, options.gps);
    transform_odometry(odometry, alignment.enu_from_world, turned);
  }
  const double global_seconds = clock.lap();

  RAYFIELD_ASSIGN(SlamResult out, into_map(section, gps, alignment, crs));
  out.offsets = {known.lidar_s + stats.offsets[0], known.spinner_rad + stats.offsets[1]};
  RunFacts facts{section, gps, alignment, stats, rig, options, gps_offset, turned};
  out.report = make_report(facts, out);
  out.report.crs = alignment.solved ? crs : std::string();
  out.report.frame_note = frame_note(gps, alignment, rig, crs, options.gps);
  if (!alignment.solved) out.report.warnings.push_back(out.report.frame_note);
  for (const std::string& w : input.warnings()) out.report.warnings.push_back(w);
  const double duration = end - epoch;
  for (const auto& [name, seconds] :
       {std::pair("read and windowed registration", window_seconds), std::pair("global registration", global_seconds)})
    out.report.stages.push_back({name, seconds, duration / std::max(seconds, 1e-9)});
  if (last) RAYFIELD_CHECK(check_quality(facts, out.report));
  return out;
}

// Two passes where the rig asks for clock or encoder offsets.
Result<SlamResult> reconstruct_with_offsets(const LogReader& read, const Rig& rig, const std::string& crs,
                                            const SlamOptions& options, Progress& progress) {
  if (!rig.estimate_lidar_offset && !(rig.spinner && rig.estimate_spinner_offset))
    return reconstruct(read, rig, {}, true, crs, options, progress);
  // The windows of the first pass mistake a tenth of an offset for motion of the vehicle in step with the spinner,
  // which stage b is too stiff to correct. In the second pass it is a tenth of a tenth.
  Clock clock;
  RAYFIELD_ASSIGN(const SlamResult first, reconstruct(read, rig, {}, false, crs, options, progress));
  const double seconds = clock.lap();
  RAYFIELD_ASSIGN(SlamResult result, reconstruct(read, rig, first.offsets, true, crs, options, progress));
  std::vector<StageTime>& stages = result.report.stages;
  const double duration = result.report.end_s - result.report.start_s;
  stages.insert(stages.begin(), StageTime{"first pass, for offsets", seconds, duration / seconds});
  return result;
}

}  // namespace

Result<SlamResult> run_slam(const LogReader& read, const Rig& rig, const std::string& crs, const SlamOptions& options,
                            Progress& progress) {
  RAYFIELD_CHECK(options.validate());
  if (!crs.empty()) RAYFIELD_CHECK(lookup_projected_crs(crs));
  RAYFIELD_ASSIGN(const SpotDepth spots, choose_spot_depth(read, rig, options, progress));
  SlamOptions limited = options;
  limited.surfels.max_spot_depth_m = spots.limit_m;
  RAYFIELD_ASSIGN(SlamResult result, reconstruct_with_offsets(read, rig, crs, limited, progress));
  note_spot_depth(rig, spots, result.report);
  return result;
}

}  // namespace rayfield::slam
