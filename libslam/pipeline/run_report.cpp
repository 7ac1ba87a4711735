#include "libslam/pipeline/run_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/pipeline/quality_check.h"

namespace rayfield::slam {
namespace {

// How far the fixes lie from the registered trajectory, the longest time without one, and what they leave open. Marks
// fixes beyond three robust standard deviations as outliers, in the result too.
GpsSummary summarise_gps(const RunFacts& f, SlamResult& result) {
  GpsSummary out;
  out.fixes = f.gps.positions.size() + f.gps.invalid;
  if (!f.alignment.solved) return out;
  out.yaw_sigma_rad = f.alignment.yaw_sigma_rad;
  out.release_shift_mean_m = f.stats.release_shift_mean_m;
  out.release_shift_max_m = f.stats.release_shift_max_m;
  std::vector<double> offsets;
  double last = 0;
  const PoseTrack& track = f.section.odometry.track;
  const double bound = 3 * 1.4826 * std::max(f.alignment.median_residual_m, f.options.gps.min_sigma_m);
  for (std::size_t k = 0; k < f.gps.positions.size(); ++k) {
    const GpsPosition& p = f.gps.positions[k];
    const double time = p.time_s;
    if (time < 0 || time > track.end_s()) continue;
    const Eigen::Vector3d offset = track.pose(time) * f.rig.imu_from_gps_m - p.enu;
    offsets.push_back(offset.head<2>().norm());
    out.mean_offset_m += offset;
    out.longest_outage_s = std::max(out.longest_outage_s, p.time_s - last);
    last = p.time_s;
    if (offsets.back() > bound) {
      ++out.outliers;
      if (k < result.gps.size()) result.gps[k].outlier = true;
    }
  }
  out.longest_outage_s = std::max(out.longest_outage_s, track.end_s() - last);
  out.used = offsets.size();
  if (offsets.empty()) return out;
  out.mean_offset_m /= static_cast<double>(offsets.size());
  std::sort(offsets.begin(), offsets.end());
  out.median_offset_m = offsets[offsets.size() / 2];
  out.p95_offset_m = offsets[offsets.size() * 95 / 100];
  out.max_offset_m = offsets.back();
  return out;
}

std::vector<DegenerateSpan> find_degenerate(const RunFacts& f) {
  std::vector<DegenerateSpan> out;
  const double epoch = f.section.odometry.epoch_s;
  for (const WindowStats& w : f.section.odometry.windows) {
    if (w.weakest_sigma_m < f.options.degenerate_sigma_m) continue;
    const double start = epoch + w.start_s, end = epoch + w.end_s;
    const Eigen::Vector3d direction = f.enu_from_world * w.weakest_direction;
    if (!out.empty() && start <= out.back().end_s) {
      out.back().end_s = end;
      if (w.weakest_sigma_m > out.back().sigma_m)
        out.back().sigma_m = w.weakest_sigma_m, out.back().direction = direction;
    } else {
      out.push_back({start, end, direction, w.weakest_sigma_m});
    }
  }
  return out;
}

}  // namespace

// Fills the report in the order of its members. Warnings come from what could not be estimated, from the quality check,
// and from what was left out.
SlamReport make_report(const RunFacts& f, SlamResult& result) {
  SlamReport r;
  const OdometryResult& odometry = f.section.odometry;
  r.start_s = odometry.epoch_s, r.end_s = odometry.epoch_s + odometry.track.end_s();
  r.length_m = result.trajectory.length_m();
  r.georeferenced = f.alignment.solved && !result.trajectory.crs.empty();
  r.stationary_start_s = odometry.initial_motion.stationary_s;
  r.initial_speed_m_s = odometry.initial_motion.velocity.norm();
  r.lidar_scans = f.section.lidar.scans, r.lidar_points = f.section.lidar.points, r.lidar_hits = f.section.lidar.hits;
  r.surfels = odometry.surfels.size();
  r.windows = static_cast<int>(odometry.windows.size());
  double squares = 0, count = 0;
  for (const WindowStats& w : odometry.windows)
    squares += w.matches * w.surfel_rms_m * w.surfel_rms_m, count += w.matches;
  r.window_surfels_m = {static_cast<std::uint64_t>(count), count > 0 ? std::sqrt(squares / count) : 0};
  r.near_surfels_m = f.stats.near_surfels, r.revisit_surfels_m = f.stats.revisit_surfels;
  r.poles_m = f.stats.poles, r.pole_depth_m = f.stats.pole_depth_m;
  r.gps_m = f.stats.gps_m;
  r.gyro_rad_s = f.stats.gyro_rad_s, r.accel_m_s2 = f.stats.accel_m_s2;
  r.loop_closures = f.stats.revisit_surfels.count;
  r.linked_visits = f.stats.linked_sections;
  r.surfel_thickness_m = f.stats.thickness_count > 0 ? f.stats.thickness_m : std::numeric_limits<double>::quiet_NaN();
  r.gps = summarise_gps(f, result);
  r.degenerate = find_degenerate(f);
  for (const PoseUncertainty& u : f.stats.uncertainty) {
    const Vector6d sigma = u.covariance.diagonal().cwiseMax(0).cwiseSqrt();
    r.uncertainty.push_back({odometry.epoch_s + u.time_s, sigma.head<3>(), sigma.tail<3>()});
  }
  if (f.rig.estimate_lidar_offset)
    r.offsets.push_back({"lidar_offset_s", result.offsets.lidar_s, f.stats.offset_sigmas[0]});
  if (f.rig.spinner && f.rig.estimate_spinner_offset)
    r.offsets.push_back({"spinner_offset_rad", result.offsets.spinner_rad, f.stats.offset_sigmas[1]});
  if (f.gps_offset.solved)
    r.offsets.push_back({"gps_offset_s", f.gps_offset.offset_s, f.gps_offset.sigma_s});
  else if (f.rig.estimate_gps_offset)
    r.warnings.push_back("the GPS time offset could not be estimated: no GPS, or no turn in the drive");
  const InertialState& middle = odometry.inertial[odometry.inertial.size() / 2].state;
  r.gyro_bias_rad_s = middle.gyro_bias, r.accel_bias_m_s2 = middle.accel_bias;
  const WindowAgreement agreement = window_agreement(odometry.windows);
  r.window_inliers_least = agreement.least, r.window_inliers_typical = agreement.typical;
  r.visit_offset_worst_m = f.stats.revisits.worst_m, r.visit_offset_typical_m = f.stats.revisits.typical_m;
  r.imu_misfit = f.stats.imu_misfit;
  add_quality_warnings(f, r);
  if (f.gps.invalid > 0)
    r.warnings.push_back(fmt::format("{} GPS messages without a usable fix left out", f.gps.invalid));
  return r;
}

}  // namespace rayfield::slam
