#include "rayfield/formats/sensor_log.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "formats/rosbag/ros_messages.h"
#include "formats/sensor_log/lidar_decoder.h"
#include "formats/sensor_log/message_order.h"
#include "formats/sensor_log/sensor_topics.h"
#include "formats/sensor_log/still_watch.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot read log";
/// What no sensor on a vehicle measures, and a single flipped bit makes: beyond 4000 °/s, 200 g and 10⁵ turns.
constexpr double kMaxRate_rad_s = 100;
constexpr double kMaxAcceleration_m_s2 = 2000;
constexpr double kMaxAngle_rad = 1e6;

/// Decodes ordered messages and hands them to the sink; keeps the counts that arise there.
class Delivery {
 public:
  Delivery(const std::string& path, const Rig& rig, SensorSink& sink)
      : path_(path), rig_(rig), sink_(sink), lidar_(rig.lidar) {}

  Result<void> deliver(SensorKind kind, const HeldMessage& message);
  TopicReport& topic(SensorKind kind) { return topics_[static_cast<std::size_t>(kind)]; }
  const LidarPointCounts& points() const { return lidar_.counts(); }
  const std::set<std::string>& other_joints() const { return other_joints_; }

 private:
  Result<DecodeState> decode(SensorKind kind, const HeldMessage& message);
  DecodeState decode_imu_message(const HeldMessage& message);
  DecodeState decode_gps_message(const HeldMessage& message);
  DecodeState decode_spinner_message(const HeldMessage& message);

  std::string path_;
  const Rig& rig_;
  SensorSink& sink_;
  LidarDecoder lidar_;
  std::array<TopicReport, 4> topics_;
  std::set<std::string> other_joints_;
  StillWatch still_;
};

DecodeState Delivery::decode_imu_message(const HeldMessage& message) {
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

DecodeState Delivery::decode_gps_message(const HeldMessage& message) {
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

DecodeState Delivery::decode_spinner_message(const HeldMessage& message) {
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
  still_.add(seconds_from_ns(message.stamp_ns), *angle);
  topic(SensorKind::spinner).longest_still_s = still_.longest_s();
  topic(SensorKind::spinner).longest_still_start_s = still_.longest_since_s();
  sink_.spinner({seconds_from_ns(message.stamp_ns), *angle});
  return DecodeState::usable;
}

Result<DecodeState> Delivery::decode(SensorKind kind, const HeldMessage& message) {
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
  const bool flat = topic(SensorKind::lidar).type == laser_scan_definition().type;
  const auto state =
      flat ? lidar_.laser_scan(message.data, message.stamp_ns) : lidar_.point_cloud2(message.data, message.stamp_ns);
  if (state && *state == DecodeState::usable) sink_.lidar(lidar_.scan());
  return state;
}

Result<void> Delivery::deliver(SensorKind kind, const HeldMessage& message) {
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

/// Topic of a sensor in a rig; nothing for a sensor that the rig lacks.
std::optional<std::string> rig_topic(const Rig& rig, SensorKind kind) {
  switch (kind) {
    case SensorKind::imu:
      return rig.imu.topic;
    case SensorKind::gps:
      return rig.gps ? std::optional(rig.gps->topic) : std::nullopt;
    case SensorKind::spinner:
      return rig.spinner ? std::optional(rig.spinner->topic) : std::nullopt;
    case SensorKind::lidar:
      break;
  }
  return rig.lidar.topic;
}

/// Which sensor each connection of the log belongs to; checks the type of those that the rig names.
class Routing {
 public:
  Routing(const std::string& path, const Rig& rig) : path_(path), rig_(rig) {}

  /// Nothing for a connection that the rig does not name.
  Result<std::optional<SensorKind>> route(const BagConnection& connection, Delivery& delivery) {
    const auto known = kinds_.find(connection.id);
    if (known != kinds_.end()) return known->second;
    std::optional<SensorKind> kind;
    for (const SensorKind each : kSensorKinds) {
      if (rig_topic(rig_, each) != connection.topic) continue;
      RAYFIELD_CHECK(check_sensor_topic(each, connection, path_));
      TopicReport& report = delivery.topic(each);
      if (!report.type.empty() && report.type != connection.type) {
        return fail(ErrorCode::bad_input, kWhat, path_ + ", topic " + connection.topic,
                    "it carries both " + report.type + " and " + connection.type);
      }
      report.type = connection.type;
      kind = each;
    }
    kinds_.emplace(connection.id, kind);
    return kind;
  }

 private:
  std::string path_;
  const Rig& rig_;
  std::map<std::uint32_t, std::optional<SensorKind>> kinds_;
};

/// A log without GPS can be used; a GPS topic that is called otherwise in the rig than in the log is a mistake.
Result<void> check_gps_topic(const Rig& rig, const std::vector<BagConnection>& connections, const std::string& path) {
  const std::optional<std::string> topic = rig_topic(rig, SensorKind::gps);
  if (!topic) return {};
  bool others = false;
  for (const BagConnection& connection : connections) {
    if (connection.topic == *topic) return {};
    others = others || serves(connection.type, SensorKind::gps);
  }
  if (others) return missing_sensor_topic(SensorKind::gps, *topic, connections, path);
  return {};
}

/// Errors for sensors that must be in the log: the first one that is not in `connections`.
Result<void> check_present(const std::string& path, const Rig& rig, const LogOptions& options,
                           const std::vector<BagConnection>& connections) {
  for (const SensorKind kind : {SensorKind::lidar, SensorKind::imu, SensorKind::spinner}) {
    if (kind == SensorKind::lidar && !options.require_lidar) continue;
    if (kind == SensorKind::imu && !options.require_imu) continue;
    if (kind == SensorKind::spinner && !options.require_lidar) continue;
    const std::optional<std::string> topic = rig_topic(rig, kind);
    if (!topic) continue;
    const auto found = std::find_if(connections.begin(), connections.end(),
                                    [&](const BagConnection& connection) { return connection.topic == *topic; });
    if (found == connections.end()) return missing_sensor_topic(kind, *topic, connections, path);
  }
  return check_gps_topic(rig, connections, path);
}

/// Errors for topics that are there and gave nothing.
Result<void> check_useful(const std::string& path, const Rig& rig, const LogOptions& options, Delivery& delivery) {
  const TopicReport& spinner = delivery.topic(SensorKind::spinner);
  if (rig.spinner && spinner.messages > 0 && spinner.delivered == 0 && !delivery.other_joints().empty()) {
    std::string joints;
    for (const std::string& joint : delivery.other_joints()) joints += (joints.empty() ? "" : ", ") + joint;
    return fail(ErrorCode::usage, kWhat, path + ", topic " + spinner.topic,
                "no message has the joint '" + rig.spinner->joint + "'; joints there: " + joints,
                "set spinner.joint in the rig file");
  }
  for (const SensorKind kind : {SensorKind::lidar, SensorKind::imu}) {
    const TopicReport& topic = delivery.topic(kind);
    const bool required = kind == SensorKind::lidar ? options.require_lidar : options.require_imu;
    if (!required || topic.delivered > 0) continue;
    const std::string why = topic.messages == 0
                                ? "there is not a single message"
                                : "not one of its " + std::to_string(topic.messages) + " messages is usable (" +
                                      std::to_string(topic.invalid) + " without a valid value, " +
                                      std::to_string(topic.undecodable) + " malformed, " +
                                      std::to_string(topic.other_segments) + " in other segments)";
    return fail(ErrorCode::bad_input, kWhat, path + ", topic " + topic.topic, why,
                "see `rayfield info` for what the log holds");
  }
  return {};
}

/// The segments as the IMU saw them, or the lidar where there is no IMU.
void report_segments(const MessageOrder& order, LogReport& report) {
  report.segments = order.segments(SensorKind::imu);
  if (report.segments.empty()) report.segments = order.segments(SensorKind::lidar);
  double longest_s = -1;
  for (std::size_t i = 0; i < report.segments.size(); ++i) {
    const double duration_s = report.segments[i].last_s - report.segments[i].first_s;
    if (report.segments[i].messages == 0 || duration_s <= longest_s) continue;
    longest_s = duration_s;
    report.longest_segment = static_cast<int>(i);
  }
}

}  // namespace

Result<void> LogOptions::validate() const {
  RAYFIELD_CHECK(bag.validate());
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  if (!within(reorder_window_s, 0, 10)) return fail(ErrorCode::usage, kWhat, "reorder_window_s", "must be 0 to 10");
  if (!within(clock_jump_back_s, 0.1, 3600)) {
    return fail(ErrorCode::usage, kWhat, "clock_jump_back_s", "must be 0.1 to 3600");
  }
  if (!within(clock_jump_forward_s, 1, 1e6)) {
    return fail(ErrorCode::usage, kWhat, "clock_jump_forward_s", "must be 1 to 1000000");
  }
  if (segment < 0) return fail(ErrorCode::usage, kWhat, "segment", "must not be negative");
  return {};
}

Result<LogReport> read_log(const std::string& path, const Rig& rig, SensorSink& sink, const LogOptions& options) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(BagReader bag, BagReader::open(path, options.bag));
  // A closed bag names its topics at once; there is no need to read gigabytes first.
  if (bag.summary().indexed && !bag.connections().empty()) {
    RAYFIELD_CHECK(check_present(path, rig, options, bag.connections()));
  }
  Delivery delivery(path, rig, sink);
  for (const SensorKind kind : kSensorKinds) delivery.topic(kind).topic = rig_topic(rig, kind).value_or("");
  Routing routing(path, rig);
  MessageOrder order(options, [&](SensorKind kind, const HeldMessage& held) { return delivery.deliver(kind, held); });
  BagMessage message;
  std::uint64_t reported = 0;
  for (;;) {
    RAYFIELD_ASSIGN(const bool more, bag.next(message));
    if (!more) break;
    order.advance(message.record_time_ns);
    RAYFIELD_ASSIGN(const std::optional<SensorKind> kind, routing.route(*message.connection, delivery));
    if (kind) {
      const std::int64_t stamp_ns = peek_ros_stamp(message.data).value_or(0);
      RAYFIELD_CHECK(order.add(*kind, stamp_ns, message.record_time_ns, message.offset, message.data));
    }
    if (options.progress != nullptr && bag.position() >= reported + (std::uint64_t{1} << 20)) {
      options.progress->advance(bag.position() - reported);
      reported = bag.position();
      if (options.progress->cancelled())
        return fail(ErrorCode::interrupted, kWhat, path, "stopped by the user", "run the same command again");
    }
  }
  RAYFIELD_CHECK(order.finish());
  LogReport report;
  for (const SensorKind kind : kSensorKinds) order.report(kind, delivery.topic(kind));
  if (bag.summary().messages == 0) {
    return fail(ErrorCode::bad_input, kWhat, path,
                "the bag holds no messages" +
                    (bag.summary().lost_bytes > 0 ? ": " + bag.summary().problems().back() : std::string()),
                "copy it from the vehicle again, or take another recording");
  }
  RAYFIELD_CHECK(check_present(path, rig, options, bag.connections()));
  RAYFIELD_CHECK(check_useful(path, rig, options, delivery));
  for (const SensorKind kind : kSensorKinds) report.topics[static_cast<std::size_t>(kind)] = delivery.topic(kind);
  report.bag = bag.summary();
  report.points = delivery.points();
  report.segment = options.segment;
  report_segments(order, report);
  return report;
}

}  // namespace rayfield::formats
