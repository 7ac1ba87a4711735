#include "libslam/input/lidar_assembler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rayfield::slam {
namespace {

constexpr double kMaxAngleGap = 0.25;       // s between encoder samples that may be interpolated across
constexpr std::size_t kMaxWaiting = 20000;  // scans held back for the encoder

double last_offset(const LidarScan& scan) {
  return scan.time_offset_s.empty() ? 0.0 : static_cast<double>(scan.time_offset_s.back());
}

}  // namespace

LidarAssembler::LidarAssembler(const Rig& rig, double lidar_offset_s, double angle_offset_rad)
    : rig_(rig), lidar_offset_s_(lidar_offset_s), angle_offset_rad_(angle_offset_rad) {}

void LidarAssembler::add(const SpinnerAngle& angle) {
  if (!std::isfinite(angle.time_s) || !std::isfinite(angle.angle_rad)) return;
  if (angles_.empty()) {
    angles_.push_back({angle.time_s, angle.angle_rad});
    return;
  }
  const AngleSample& last = angles_.back();
  if (angle.time_s <= last.time_s) return;
  // Encoders wrap: the turn between two samples is the representative nearest to the last rate's prediction.
  double expected = 0;
  if (angles_.size() > 1) {
    const AngleSample& before = angles_[angles_.size() - 2];
    expected = (last.angle_rad - before.angle_rad) / (last.time_s - before.time_s) * (angle.time_s - last.time_s);
    if (angle.time_s - last.time_s > kMaxAngleGap) expected = 0;
  }
  const double turn = expected + std::remainder(angle.angle_rad - last.angle_rad - expected, 2 * std::numbers::pi);
  counts_.spinner_turn_rad += std::abs(turn);
  angles_.push_back({angle.time_s, last.angle_rad + turn});
}

void LidarAssembler::add(const LidarScan& scan) {
  ++counts_.scans;
  const std::size_t n = scan.range_m.size();
  if (!std::isfinite(scan.time_s) || scan.direction.size() != n || scan.time_offset_s.size() != n ||
      (!scan.intensity.empty() && scan.intensity.size() != n)) {
    ++counts_.unusable_scans;
    return;
  }
  if (scan.time_s <= last_scan_s_) {
    ++counts_.late_scans;
    return;
  }
  last_scan_s_ = scan.time_s;
  waiting_.push_back(scan);
}

bool LidarAssembler::angle_at(double time_s, double& angle, double& rate) {
  if (angles_.size() < 2) return false;
  cursor_ = std::min(cursor_, angles_.size() - 2);
  while (cursor_ > 0 && angles_[cursor_].time_s > time_s) --cursor_;
  while (cursor_ + 2 < angles_.size() && angles_[cursor_ + 1].time_s < time_s) ++cursor_;
  const AngleSample &a = angles_[cursor_], &b = angles_[cursor_ + 1];
  const double gap = b.time_s - a.time_s;
  // A point may lie a few samples outside the encoder's record, at the ends of the log.
  if (gap > kMaxAngleGap || time_s < a.time_s - 0.05 || time_s > b.time_s + 0.05) return false;
  rate = (b.angle_rad - a.angle_rad) / gap;
  angle = a.angle_rad + rate * (time_s - a.time_s);
  return true;
}

// Applies the rig's range limits and brings every usable point into the IMU frame. Points whose angle is unknown are
// left out.
void LidarAssembler::assemble(const LidarScan& scan, BodyScan& out) {
  out.clear();
  const std::size_t n = scan.range_m.size();
  const bool spins = rig_.spinner.has_value();
  const Eigen::Vector3d axis = spins ? rig_.spinner->axis : Eigen::Vector3d::UnitZ();
  const Rigid3& imu_from_spinner = rig_.imu_from_spinner;
  const Eigen::Matrix3d spinner_from_lidar = rig_.spinner_from_lidar.rotation.toRotationMatrix();
  const Eigen::Matrix3d outer = imu_from_spinner.rotation.toRotationMatrix();
  const Eigen::Vector3d arm = rig_.spinner_from_lidar.translation;
  Eigen::Matrix3d imu_from_lidar = outer * spinner_from_lidar;
  Eigen::Vector3d origin = outer * arm + imu_from_spinner.translation;
  bool angle_missing = false;
  for (std::size_t k = 0; k < n; ++k) {
    ++counts_.points;
    float range = scan.range_m[k];
    const Eigen::Vector3f& d = scan.direction[k];
    const bool far = range > 0 && static_cast<double>(range) >= rig_.lidar.max_range_m;
    if (far) range = std::numeric_limits<float>::infinity();
    if (std::isnan(range) || static_cast<double>(range) < rig_.lidar.min_range_m ||
        !(std::abs(d.squaredNorm() - 1) < 1e-3f) || !std::isfinite(scan.time_offset_s[k])) {
      ++counts_.invalid_points;
      continue;
    }
    const double time = scan.time_s + static_cast<double>(scan.time_offset_s[k]) + lidar_offset_s_;
    double rate = 0;
    if (spins) {
      double angle = 0;
      if (!angle_at(time, angle, rate)) {
        angle_missing = true;
        continue;
      }
      const Eigen::Matrix3d imu_from_turned =
          outer * Eigen::AngleAxisd(angle + angle_offset_rad_, axis).toRotationMatrix();
      imu_from_lidar = imu_from_turned * spinner_from_lidar;
      origin = imu_from_turned * arm + imu_from_spinner.translation;
    }
    if (std::isfinite(range)) ++counts_.hits;
    out.time_s.push_back(time);
    out.origin.push_back(origin);
    out.direction.push_back(imu_from_lidar * d.cast<double>());
    out.range_m.push_back(range);
    out.intensity.push_back(scan.intensity.empty() ? 0.0f : scan.intensity[k]);
    out.spin_rate_rad_s.push_back(static_cast<float>(rate));
  }
  if (angle_missing) ++counts_.scans_without_angle;
}

void LidarAssembler::drain(const std::function<void(const BodyScan&)>& take, bool flush) {
  while (!waiting_.empty()) {
    const LidarScan& scan = waiting_.front();
    const double end = scan.time_s + last_offset(scan) + lidar_offset_s_;
    const bool covered = !rig_.spinner || (!angles_.empty() && angles_.back().time_s >= end);
    if (!covered && !flush && waiting_.size() < kMaxWaiting) break;
    assemble(scan, scratch_);
    waiting_.pop_front();
    take(scratch_);
  }
  // Encoder samples older than a second before the next scan are not needed again.
  const double keep_from = (waiting_.empty() ? last_scan_s_ : waiting_.front().time_s) + lidar_offset_s_ - 1.0;
  while (angles_.size() > 4 && angles_[2].time_s < keep_from) {
    angles_.pop_front();
    if (cursor_ > 0) --cursor_;
  }
}

}  // namespace rayfield::slam
