#include "formats/sensor_log/log_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "formats/sensor_log/point_time.h"
#include "rayfield/core/median.h"

namespace rayfield::formats {

void StampStatistics::add(std::int64_t stamp_ns, std::int64_t log_clock_ns, const LogOptions& options) {
  constexpr double kShortestGap_s = 0.1;
  if (messages_++ == 0) {
    first_ns_ = last_ns_ = latest_ns_ = stamp_ns;
    last_clock_ns_ = log_clock_ns;
    return;
  }
  const double interval_s = static_cast<double>(stamp_ns - last_ns_) * 1e-9;
  last_ns_ = stamp_ns;
  first_ns_ = std::min(first_ns_, stamp_ns);
  latest_ns_ = std::max(latest_ns_, stamp_ns);
  const double passed_s = static_cast<double>(log_clock_ns - last_clock_ns_) * 1e-9;
  last_clock_ns_ = log_clock_ns;
  if (interval_s < -options.clock_jump_back_s || interval_s - passed_s > options.clock_jump_forward_s) {
    ++clock_jumps_;
    return;
  }
  if (interval_s < 0) ++backwards_;
  if (interval_s == 0) ++repeated_;
  if (interval_s <= 0) return;
  if (intervals_s_.size() < kIntervals) intervals_s_.push_back(interval_s);
  if (intervals_s_.size() == kLearning) usual_s_ = usual_interval_s();
  longest_gap_s_ = std::max(longest_gap_s_, interval_s);
  if (usual_s_ > 0 && interval_s > 5 * usual_s_ && interval_s > kShortestGap_s) ++gaps_;
}

double StampStatistics::usual_interval_s() const { return median_of(intervals_s_, 0); }

void StampStatistics::report(TopicInfo& topic) const {
  topic.messages = messages_;
  topic.first_s = seconds_from_ns(first_ns_);
  topic.last_s = seconds_from_ns(latest_ns_);
  const double usual_s = usual_interval_s();
  topic.rate_hz = usual_s > 0 ? 1.0 / usual_s : 0.0;
  topic.longest_gap_s = longest_gap_s_;
  topic.gaps = gaps_;
  topic.backwards = backwards_;
  topic.repeated = repeated_;
  topic.clock_jumps = clock_jumps_;
}

void LidarStatistics::add_range(double range_m) {
  ++info_.points;
  if (std::isnan(range_m)) {
    ++info_.nan;
  } else if (std::isinf(range_m)) {
    ++info_.infinite;
  } else if (range_m == 0) {
    ++info_.zero;
  } else if (range_m > 0) {
    constexpr double kSame = 1e-4;
    if (info_.smallest_m == 0 || range_m < info_.smallest_m) info_.smallest_m = range_m;
    if (range_m > info_.largest_m * (1 + kSame)) info_.at_largest = 0;
    info_.largest_m = std::max(info_.largest_m, range_m);
    if (range_m >= info_.largest_m * (1 - kSame)) ++info_.at_largest;
  }
}

void LidarStatistics::add(const LaserScanView& scan) {
  ++messages_, ++looked_at_;
  for (std::size_t i = 0; i < scan.beams(); ++i) {
    add_range(static_cast<double>(load<float>(scan.ranges.data() + i * sizeof(float))));
  }
  add_limits(scan);
}

// A beam without echoes has met nothing.
void LidarStatistics::add(const MultiEchoLaserScanView& scan) {
  ++messages_, ++looked_at_;
  for (const std::span<const std::byte> beam : scan.ranges) {
    if (beam.empty()) add_range(std::numeric_limits<double>::infinity());
    if (beam.size() > sizeof(float)) ++info_.several_echoes;
    for (std::size_t at = 0; at < beam.size(); at += sizeof(float))
      add_range(static_cast<double>(load<float>(beam.data() + at)));
  }
  add_limits(scan);
}

void LidarStatistics::add_limits(const PlaneScanView& scan) {
  info_.range_min_m = static_cast<double>(scan.range_min);
  info_.range_max_m = static_cast<double>(scan.range_max);
  info_.time_increment_s = static_cast<double>(scan.time_increment);
}

void LidarStatistics::add(const PointCloud2View& cloud) {
  constexpr std::uint64_t kEvery = 10;
  if (messages_++ % kEvery != 0) return;
  ++looked_at_;
  if (info_.fields.empty()) {
    info_.fields = cloud.field_names();
    info_.has_point_time = PointTime::find(cloud, 0).has_value();
  }
  const PointFieldView* x = cloud.find("x");
  const PointFieldView* y = cloud.find("y");
  const PointFieldView* z = cloud.find("z");
  if (x == nullptr || y == nullptr || z == nullptr || cloud.big_endian) return;
  for (std::uint32_t row = 0; row < cloud.height; ++row) {
    const std::byte* point = cloud.data.data() + std::size_t{row} * cloud.row_step;
    for (std::uint32_t column = 0; column < cloud.width; ++column, point += cloud.point_step) {
      add_range(Eigen::Vector3d(x->value(point), y->value(point), z->value(point)).norm());
    }
  }
}

LidarInfo LidarStatistics::report() const {
  LidarInfo info = info_;
  if (looked_at_ > 0) info.points_per_message = static_cast<double>(info.points) / static_cast<double>(looked_at_);
  return info;
}

void ImuStatistics::add(const ImuSample& sample) {
  const double acceleration = sample.linear_acceleration_m_s2.norm();
  const double rate = sample.angular_velocity_rad_s.norm();
  if (!std::isfinite(acceleration) || !std::isfinite(rate)) {
    ++info_.invalid;
    return;
  }
  ++samples_;
  acceleration_sum_ += acceleration;
  info_.largest_rate_rad_s = std::max(info_.largest_rate_rad_s, rate);
}

ImuInfo ImuStatistics::report() const {
  ImuInfo info = info_;
  if (samples_ > 0) info.mean_acceleration_m_s2 = acceleration_sum_ / static_cast<double>(samples_);
  return info;
}

void GpsStatistics::add(const GpsFix& fix) {
  const bool finite = std::isfinite(fix.latitude_deg + fix.longitude_deg + fix.height_m);
  if (fix.status < 0 || !finite || std::abs(fix.latitude_deg) > 90) {
    ++info_.without_fix;
    return;
  }
  const bool first = info_.fixes++ == 0;
  const auto widen = [first](double value, double& low, double& high) {
    low = first ? value : std::min(low, value);
    high = first ? value : std::max(high, value);
  };
  widen(fix.latitude_deg, info_.south_deg, info_.north_deg);
  widen(fix.longitude_deg, info_.west_deg, info_.east_deg);
  widen(fix.height_m, info_.lowest_m, info_.highest_m);
}

void JointStatistics::add(const JointStateView& state, double time_s) {
  constexpr std::size_t kMaxJoints = 32;
  constexpr std::size_t kMaxName = 256;
  const std::size_t count = std::min(state.name.size(), state.position.size() / sizeof(double));
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view name = state.name[i];
    const double angle = load<double>(state.position.data() + i * sizeof(double));
    if (!std::isfinite(angle) || name.size() > kMaxName) continue;
    const auto joint = std::find_if(joints_.begin(), joints_.end(), [&](const Joint& j) { return j.name == name; });
    if (joint == joints_.end()) {
      if (joints_.size() >= kMaxJoints) continue;
      joints_.push_back({std::string(name), angle, 0, {}});
      joints_.back().stationary.add(time_s, angle);
      continue;
    }
    joint->stationary.add(time_s, angle);
    joint->travelled_rad += std::abs(std::remainder(angle - joint->last_rad, 2 * std::numbers::pi));
    joint->last_rad = angle;
  }
}

std::vector<JointInfo> JointStatistics::report() const {
  std::vector<JointInfo> list;
  for (const Joint& joint : joints_)
    list.push_back({topic_, joint.name, joint.travelled_rad, joint.stationary.longest_s()});
  return list;
}

}  // namespace rayfield::formats
