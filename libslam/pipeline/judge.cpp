#include "libslam/pipeline/judge.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayfield::slam {
namespace {

constexpr double kMaxSpeed = 15;           // m/s, of a vehicle between vines
constexpr double kMinInliers = 0.5;        // share of matches within three standard deviations
constexpr double kMaxBlindFraction = 0.3;  // share of windows with hardly any match
constexpr int kFewMatches = 30;
// Largest mean residual of the IMU over a straight stretch, standard deviations. Maps that are right: 1.2–1.9; with a
// lane taken for the next one, 2.7 and more.
constexpr double kDoubtfulMisfit = 2.5, kMaxMisfit = 8;
constexpr double kMaxTail = 4;  // 95 % of the fixes lie within so many times the bound of their median

// How far the worst stretch of a drive may stand out from the others: as a multiple of them, and m.
struct VisitLimit {
  double ratio, offset_m;
};
constexpr VisitLimit kDoubtfulVisits = {2.5, 0.02}, kTornVisits = {5.0, 0.04};

bool exceeds(const VisitMisfit& visits, const VisitLimit& limit) {
  return visits.typical_m > 0 && visits.worst_m > limit.offset_m && visits.worst_m > limit.ratio * visits.typical_m;
}

// The window whose surfaces agree least, and how many usually do.
struct WindowAgreement {
  double least = 1, typical = 1, at_s = 0;
};
constexpr double kDoubtfulAgreement = 0.9, kBrokenAgreement = 0.75;  // least / typical

WindowAgreement agreement_of(const std::vector<WindowStats>& windows) {
  WindowAgreement out;
  std::vector<double> shares;
  for (const WindowStats& w : windows) {
    if (w.matches < kFewMatches) continue;
    shares.push_back(w.inlier_fraction);
    if (w.inlier_fraction < out.least) out.least = w.inlier_fraction, out.at_s = 0.5 * (w.start_s + w.end_s);
  }
  if (!shares.empty()) out.typical = median_of(std::move(shares));
  return out;
}

GpsSummary summarise_gps(const RunFacts& f, SlamResult& result) {
  GpsSummary out;
  out.fixes = f.gps.positions.size() + f.gps.invalid;
  if (!f.alignment.solved) return out;
  out.yaw_sigma_rad = f.alignment.yaw_sigma_rad;
  out.release_shift_mean_m = f.stats.release_shift_mean_m;
  out.release_shift_max_m = f.stats.release_shift_max_m;
  std::vector<double> offsets;
  double last = 0;
  const PoseTrack& track = f.drive.odometry.track;
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
  const double epoch = f.drive.odometry.epoch_s;
  for (const WindowStats& w : f.drive.odometry.windows) {
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

tl::unexpected<Error> failed(std::string_view why, std::string_view next) {
  return fail(ErrorCode::bad_input, "cannot reconstruct the drive", "trajectory", why, next);
}

}  // namespace

SlamReport make_report(const RunFacts& f, SlamResult& result) {
  SlamReport r;
  const OdometryResult& odometry = f.drive.odometry;
  r.start_s = odometry.epoch_s, r.end_s = odometry.epoch_s + odometry.track.end_s();
  r.length_m = result.trajectory.length_m();
  r.georeferenced = f.alignment.solved && !result.trajectory.crs.empty();
  r.stationary_start_s = odometry.start.stationary_s;
  r.initial_speed_m_s = odometry.start.velocity.norm();
  r.lidar_scans = f.drive.lidar.scans, r.lidar_points = f.drive.lidar.points, r.lidar_hits = f.drive.lidar.hits;
  r.surfels = odometry.surfels.size();
  r.windows = static_cast<int>(odometry.windows.size());
  double squares = 0, count = 0;
  for (const WindowStats& w : odometry.windows)
    squares += w.matches * w.surfel_rms_m * w.surfel_rms_m, count += w.matches;
  r.window_surfels_m = {static_cast<std::uint64_t>(count), count > 0 ? std::sqrt(squares / count) : 0};
  const auto plain = [](const ResidualStats& s) { return ResidualSummary{s.count, s.rms}; };
  r.near_surfels_m = plain(f.stats.near_surfels), r.revisit_surfels_m = plain(f.stats.revisit_surfels);
  r.poles_m = plain(f.stats.poles), r.pole_depth_m = f.stats.pole_depth_m;
  r.gps_m = plain(f.stats.gps_m);
  r.gyro_rad_s = plain(f.stats.gyro_rad_s), r.accel_m_s2 = plain(f.stats.accel_m_s2);
  r.loop_closures = f.stats.revisit_surfels.count;
  r.linked_visits = f.stats.linked_visits;
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
  if (!r.degenerate.empty())
    r.warnings.push_back(fmt::format("{} stretches where lidar alone does not hold the position", r.degenerate.size()));
  if (f.stats.thickness_count == 0) r.warnings.push_back("no surface was seen twice: nothing closes the drive's loops");
  const WindowAgreement agreement = agreement_of(odometry.windows);
  r.window_inliers_least = agreement.least, r.window_inliers_typical = agreement.typical;
  if (agreement.least < kDoubtfulAgreement * agreement.typical)
    r.warnings.push_back(fmt::format(
        "around {:.0f} s after the start only {:.0f} % of the surfaces seen twice agree ({:.0f} % elsewhere): "
        "the IMU or the lidar may have been disturbed there",
        agreement.at_s, 100 * agreement.least, 100 * agreement.typical));
  const VisitMisfit& visits = f.stats.visits;
  r.visit_offset_worst_m = visits.worst_m, r.visit_offset_typical_m = visits.typical_m;
  if (exceeds(visits, kDoubtfulVisits))
    r.warnings.push_back(fmt::format(
        "around {:.0f} s after the start surfaces of different visits are up to {:.0f} mm apart ({:.0f} mm elsewhere): "
        "the map may be torn there",
        visits.worst_s, 1000 * visits.worst_m, 1000 * visits.typical_m));
  r.imu_misfit = f.stats.imu_misfit;
  if (r.imu_misfit > kDoubtfulMisfit)
    r.warnings.push_back(fmt::format(
        "around {:.0f} s after the start the path contradicts the IMU by {:.1f} standard deviations: a lane "
        "may have been taken for the next one there, or the IMU is noisier than the rig file says",
        f.stats.imu_misfit_s, r.imu_misfit));
  if (f.gps.invalid > 0)
    r.warnings.push_back(fmt::format("{} GPS messages without a usable fix left out", f.gps.invalid));
  return r;
}

Result<void> judge(const RunFacts& f, const SlamReport& report) {
  const PoseTrack& track = f.drive.odometry.track;
  for (int k = 0; k + 50 < track.size(); k += 50) {
    const double speed = (track.position[k + 50] - track.position[k]).norm() / (50 * track.step_s);
    if (!(speed < kMaxSpeed))
      return failed(fmt::format("it moves at {:.1f} m/s {:.1f} s after its start", speed, k * track.step_s),
                    "check the extrinsics, the IMU's units and the clocks");
  }
  int blind = 0;
  double inliers = 0;
  for (const WindowStats& w : f.drive.odometry.windows) {
    blind += w.matches < kFewMatches;
    inliers += w.inlier_fraction / static_cast<double>(report.windows);
  }
  if (blind > kMaxBlindFraction * report.windows)
    return failed(fmt::format("hardly any surface was seen twice in {} of {} windows", blind, report.windows),
                  "the site is too open for the lidar's range, or the lidar's data are damaged");
  if (inliers < kMinInliers)
    return failed(fmt::format("only {:.0f} % of the surfaces seen twice agree", 100 * inliers),
                  "check the extrinsics, the spinner's axis and the clocks in the rig file");
  const WindowAgreement agreement = agreement_of(f.drive.odometry.windows);
  if (agreement.least < kBrokenAgreement * agreement.typical)
    return failed(
        fmt::format("around {:.0f} s after its start only {:.0f} % of the surfaces seen twice agree ({:.0f} % "
                    "elsewhere)",
                    agreement.at_s, 100 * agreement.least, 100 * agreement.typical),
        "the IMU or the lidar was disturbed there: see `rayfield info LOG`, or split the log at that time");
  if (report.surfel_thickness_m > f.options.max_thickness_m)
    return failed(fmt::format("surfaces seen again are {:.0f} mm thick", 1000 * report.surfel_thickness_m),
                  "check the extrinsics and the clocks in the rig file");
  if (exceeds(f.stats.visits, kTornVisits))
    return failed(fmt::format("around {:.0f} s after its start surfaces of different visits are up to {:.0f} mm apart "
                              "({:.0f} mm elsewhere): the map is torn, a lane may have been taken for the next one",
                              f.stats.visits.worst_s, 1000 * f.stats.visits.worst_m, 1000 * f.stats.visits.typical_m),
                  "check the IMU's noise in the rig file and GPS over the block; or split the log before that time");
  if (report.imu_misfit > kMaxMisfit)
    return failed(fmt::format("around {:.0f} s after its start it contradicts the IMU by {:.0f} standard deviations",
                              f.stats.imu_misfit_s, report.imu_misfit),
                  "check the IMU's noise in the rig file and the extrinsics; or lanes were taken for one another");
  if (f.alignment.solved && report.gps.median_offset_m > f.options.gps.max_residual_m)
    return failed(fmt::format("half of the GPS fixes are more than {:.1f} m off", report.gps.median_offset_m),
                  "the GPS or its clock is at fault: check time.gps_offset_s, or leave [gps] out of the rig file");
  if (f.alignment.solved && report.gps.p95_offset_m > kMaxTail * f.options.gps.max_residual_m)
    return failed(fmt::format("one GPS fix in twenty is more than {:.0f} m off", report.gps.p95_offset_m),
                  "a part of the drive went astray: check the log for gaps and spikes of the IMU (rayfield info LOG)");
  return {};
}

}  // namespace rayfield::slam
