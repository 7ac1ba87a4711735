#include "formats/sensor_log/sensor_dispatcher.h"

#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "formats/rosbag/ros_decode.h"
#include "formats/rosbag/ros_definitions.h"

namespace rayfield::formats {
namespace {

/// What no sensor on a vehicle measures, and a single flipped bit makes: beyond 4000 °/s, 200 g and 10⁵ turns.
constexpr double kMaxRate_rad_s = 100;
constexpr double kMaxAcceleration_m_s2 = 2000;
constexpr double kMaxAngle_rad = 1e6;

}  // namespace

DecodeState SensorDispatcher::decode_imu_message(const BufferedMessage& message) {
  std::optional<ImuSample> sample = decode_imu(message.data);
  if (!sample) return DecodeState::undecodable;
  // Also false for NaN.
  if (!(sample->angular_velocity_rad_s.norm() < kMaxRate_rad_s) ||
      !(sample->linear_acceleration_m_s2.norm() < kMaxAcceleration_m_s2)) {
    return DecodeState::invalid;
  }
  sample->time_s = seconds_from_ns(message.stamp_ns);
  sink_.imu(*sample);
  return DecodeState::usable;
}

DecodeState SensorDispatcher::decode_gps_message(const BufferedMessage& message) {
  std::optional<GpsFix> fix = decode_nav_sat_fix(message.data);
  if (!fix) return DecodeState::undecodable;
  if (!std::isfinite(fix->latitude_deg + fix->longitude_deg + fix->height_m) || std::abs(fix->latitude_deg) > 90.0 ||
      std::abs(fix->longitude_deg) > 360.0) {
    if (fix->status >= 0) return DecodeState::invalid;
  }
  if (fix->status < 0) {
    ++topic(SensorKind::gps).without_position;
    return DecodeState::invalid;
  }
  if (!fix->covariance_enu_m2.allFinite()) {
    fix->covariance_enu_m2.setZero();
    fix->covariance_type = 0;
  }
  fix->time_s = seconds_from_ns(message.stamp_ns);
  sink_.gps(*fix);
  return DecodeState::usable;
}

DecodeState SensorDispatcher::decode_spinner_message(const BufferedMessage& message) {
  const std::optional<JointStateView> state = decode_joint_state(message.data);
  if (!state) return DecodeState::undecodable;
  const std::optional<double> angle = joint_position(*state, rig_.spinner->joint);
  if (!angle) {
    constexpr std::size_t kMaxNames = 16;
    for (const std::string_view name : state->name) {
      if (other_joints_.size() < kMaxNames) other_joints_.emplace(name.substr(0, 64));
    }
  }
  if (!angle || !(std::abs(*angle) < kMaxAngle_rad)) return DecodeState::invalid;
  stationary_.add(seconds_from_ns(message.stamp_ns), *angle);
  topic(SensorKind::spinner).longest_stationary_s = stationary_.longest_s();
  topic(SensorKind::spinner).longest_stationary_start_s = stationary_.longest_since_s();
  sink_.spinner({seconds_from_ns(message.stamp_ns), *angle});
  return DecodeState::usable;
}

Result<DecodeState> SensorDispatcher::decode(SensorKind kind, const BufferedMessage& message) {
  switch (kind) {
    case SensorKind::imu:
      return decode_imu_message(message);
    case SensorKind::gps:
      return decode_gps_message(message);
    case SensorKind::spinner:
      return decode_spinner_message(message);
    case SensorKind::lidar:
      break;
  }
  const std::string_view type = topic(SensorKind::lidar).type;
  auto state = type == laser_scan_definition().type ? lidar_.laser_scan(message.data, message.stamp_ns)
               : type == multi_echo_laser_scan_definition().type
                   ? lidar_.multi_echo_laser_scan(message.data, message.stamp_ns)
                   : lidar_.point_cloud2(message.data, message.stamp_ns);
  if (state && *state == DecodeState::usable) sink_.lidar(lidar_.scan());
  return state;
}

Result<void> SensorDispatcher::dispatch(SensorKind kind, const BufferedMessage& message) {
  TopicReport& counts = topic(kind);
  Result<DecodeState> state = decode(kind, message);
  if (!state) {
    Error error = state.error();
    error.where = path_ + ", topic " + counts.topic + ", at byte " + std::to_string(message.offset);
    return tl::make_unexpected(std::move(error));
  }
  if (*state == DecodeState::undecodable) ++counts.undecodable;
  if (*state == DecodeState::invalid) ++counts.invalid;
  if (*state != DecodeState::usable) return {};
  const double stamp_s = seconds_from_ns(message.stamp_ns);
  if (counts.delivered == 0) {
    counts.first_s = stamp_s;
  } else if (stamp_s - counts.last_s > counts.longest_gap_s) {
    counts.longest_gap_s = stamp_s - counts.last_s;
    counts.longest_gap_start_s = counts.last_s;
  }
  counts.last_s = stamp_s;
  ++counts.delivered;
  return {};
}

}  // namespace rayfield::formats
