#include "libslam/pipeline/quality_check.h"

#include <fmt/core.h>

#include <vector>

#include "rayfield/core/median.h"

namespace rayfield::slam {
namespace {

constexpr double kMaxSpeed = 15;           // m/s, of a vehicle between vines
constexpr double kMinInliers = 0.5;        // share of matches within three standard deviations
constexpr double kMaxBlindFraction = 0.3;  // share of windows with hardly any match
constexpr int kFewMatches = 30;
// Largest mean residual of the IMU over a straight section, standard deviations: 1.2–1.9 in correct maps, 2.7 and more
// with a lane that was taken for the next one.
constexpr double kDoubtfulImuMisfit = 2.5, kMaxImuMisfit = 8;
constexpr double kMaxTail = 4;  // 95 % of the fixes lie within so many times the bound of their median

// How far the worst section of a drive may stand out from the others: as a multiple of them, and m.
struct MisfitLimit {
  double ratio, offset_m;
};
constexpr MisfitLimit kDoubtfulRevisits = {2.5, 0.02}, kTornRevisits = {5.0, 0.04};

bool exceeds(const RevisitMisfit& misfit, const MisfitLimit& limit) {
  return misfit.typical_m > 0 && misfit.worst_m > limit.offset_m && misfit.worst_m > limit.ratio * misfit.typical_m;
}

constexpr double kDoubtfulAgreement = 0.9, kBrokenAgreement = 0.75;  // least / typical

tl::unexpected<Error> failed(std::string_view why, std::string_view next) {
  return fail(ErrorCode::bad_input, "cannot reconstruct the drive", "trajectory", why, next);
}

Result<void> check_speed(const PoseTrack& track) {
  for (int k = 0; k + 50 < track.size(); k += 50) {
    const double speed = (track.position[k + 50] - track.position[k]).norm() / (50 * track.step_s);
    if (!(speed < kMaxSpeed))
      return failed(fmt::format("it moves at {:.1f} m/s {:.1f} s after its start", speed, k * track.step_s),
                    "check the extrinsics, the IMU's units and the clocks");
  }
  return {};
}

// Surfaces seen twice within a window: enough of them, and in agreement.
Result<void> check_windows(const RunFacts& f, const SlamReport& report) {
  int blind = 0;
  double inliers = 0;
  for (const WindowStats& w : f.section.odometry.windows) {
    blind += w.matches < kFewMatches;
    inliers += w.inlier_fraction / static_cast<double>(report.windows);
  }
  if (blind > kMaxBlindFraction * report.windows)
    return failed(fmt::format("hardly any surface was seen twice in {} of {} windows", blind, report.windows),
                  "the site is too open for the lidar's range, or the lidar's data are damaged");
  if (inliers < kMinInliers)
    return failed(fmt::format("only {:.0f} % of the surfaces seen twice agree", 100 * inliers),
                  "check the extrinsics, the spinner's axis and the clocks in the rig file");
  const WindowAgreement agreement = window_agreement(f.section.odometry.windows);
  if (agreement.least < kBrokenAgreement * agreement.typical)
    return failed(
        fmt::format("around {:.0f} s after its start only {:.0f} % of the surfaces seen twice agree ({:.0f} % "
                    "elsewhere)",
                    agreement.at_s, 100 * agreement.least, 100 * agreement.typical),
        "the IMU or the lidar was disturbed there: see `rayfield info LOG`, or split the log at that time");
  return {};
}

// Surfaces seen in different passes, and the IMU against the trajectory.
Result<void> check_map(const RunFacts& f, const SlamReport& report) {
  if (report.surfel_thickness_m > f.options.max_thickness_m)
    return failed(fmt::format("surfaces seen again are {:.0f} mm thick", 1000 * report.surfel_thickness_m),
                  "check the extrinsics and the clocks in the rig file");
  if (exceeds(f.stats.revisits, kTornRevisits))
    return failed(
        fmt::format("around {:.0f} s after its start surfaces of different passes are up to {:.0f} mm apart "
                    "({:.0f} mm elsewhere): the map is torn, a lane may have been taken for the next one",
                    f.stats.revisits.worst_s, 1000 * f.stats.revisits.worst_m, 1000 * f.stats.revisits.typical_m),
        "check the IMU's noise in the rig file and GPS over the block; or split the log before that time");
  if (report.imu_misfit > kMaxImuMisfit)
    return failed(fmt::format("around {:.0f} s after its start it contradicts the IMU by {:.0f} standard deviations",
                              f.stats.imu_misfit_s, report.imu_misfit),
                  "check the IMU's noise in the rig file and the extrinsics; or lanes were taken for one another");
  return {};
}

Result<void> check_gps(const RunFacts& f, const SlamReport& report) {
  if (f.alignment.solved && report.gps.median_offset_m > f.options.gps.max_residual_m)
    return failed(fmt::format("half of the GPS fixes are more than {:.1f} m off", report.gps.median_offset_m),
                  "the GPS or its clock is at fault: check time.gps_offset_s, or leave [gps] out of the rig file");
  if (f.alignment.solved && report.gps.p95_offset_m > kMaxTail * f.options.gps.max_residual_m)
    return failed(fmt::format("one GPS fix in twenty is more than {:.0f} m off", report.gps.p95_offset_m),
                  "a part of the drive was reconstructed wrongly: check the log for gaps and spikes of the IMU "
                  "(rayfield info LOG)");
  return {};
}

}  // namespace

WindowAgreement window_agreement(std::span<const WindowStats> windows) {
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

// Limits at which a result is still accepted, but doubtful. They are well above those of correct maps.
void add_quality_warnings(const RunFacts& f, SlamReport& report) {
  if (!report.degenerate.empty())
    report.warnings.push_back(
        fmt::format("{} sections where lidar alone does not determine the position", report.degenerate.size()));
  if (f.stats.thickness_count == 0)
    report.warnings.push_back("no surface was seen twice: nothing closes the drive's loops");
  const WindowAgreement agreement = window_agreement(f.section.odometry.windows);
  if (agreement.least < kDoubtfulAgreement * agreement.typical)
    report.warnings.push_back(fmt::format(
        "around {:.0f} s after the start only {:.0f} % of the surfaces seen twice agree ({:.0f} % elsewhere): "
        "the IMU or the lidar may have been disturbed there",
        agreement.at_s, 100 * agreement.least, 100 * agreement.typical));
  const RevisitMisfit& revisits = f.stats.revisits;
  if (exceeds(revisits, kDoubtfulRevisits))
    report.warnings.push_back(fmt::format(
        "around {:.0f} s after the start surfaces of different passes are up to {:.0f} mm apart ({:.0f} mm elsewhere): "
        "the map may be torn there",
        revisits.worst_s, 1000 * revisits.worst_m, 1000 * revisits.typical_m));
  if (report.imu_misfit > kDoubtfulImuMisfit)
    report.warnings.push_back(fmt::format(
        "around {:.0f} s after the start the path contradicts the IMU by {:.1f} standard deviations: a lane "
        "may have been taken for the next one there, or the IMU is noisier than the rig file says",
        f.stats.imu_misfit_s, report.imu_misfit));
}

Result<void> check_quality(const RunFacts& f, const SlamReport& report) {
  RAYFIELD_CHECK(check_speed(f.section.odometry.track));
  RAYFIELD_CHECK(check_windows(f, report));
  RAYFIELD_CHECK(check_map(f, report));
  return check_gps(f, report);
}

}  // namespace rayfield::slam
