#include "rayfield/formats/sensor_log.h"

#include <algorithm>
#include <map>
#include <optional>

#include "formats/rosbag/ros_header.h"
#include "formats/sensor_log/read_progress.h"
#include "formats/sensor_log/reorder_buffer.h"
#include "formats/sensor_log/sensor_dispatcher.h"
#include "formats/sensor_log/sensor_topics.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot read log";
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
class TopicRouter {
 public:
  TopicRouter(const std::string& path, const Rig& rig) : path_(path), rig_(rig) {}

  /// Nothing for a connection that the rig does not name.
  Result<std::optional<SensorKind>> route(const BagConnection& connection, SensorDispatcher& dispatcher) {
    const auto known = kinds_.find(connection.id);
    if (known != kinds_.end()) return known->second;
    std::optional<SensorKind> kind;
    for (const SensorKind each : kSensorKinds) {
      if (rig_topic(rig_, each) != connection.topic) continue;
      RAYFIELD_CHECK(check_sensor_topic(each, connection, path_));
      TopicReport& report = dispatcher.topic(each);
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
Result<void> check_useful(const std::string& path, const Rig& rig, const LogOptions& options,
                          SensorDispatcher& dispatcher) {
  const TopicReport& spinner = dispatcher.topic(SensorKind::spinner);
  if (rig.spinner && spinner.messages > 0 && spinner.delivered == 0 && !dispatcher.other_joints().empty()) {
    std::string joints;
    for (const std::string& joint : dispatcher.other_joints()) joints += (joints.empty() ? "" : ", ") + joint;
    return fail(ErrorCode::usage, kWhat, path + ", topic " + spinner.topic,
                "no message has the joint '" + rig.spinner->joint + "'; joints there: " + joints,
                "set spinner.joint in the rig file");
  }
  for (const SensorKind kind : {SensorKind::lidar, SensorKind::imu}) {
    const TopicReport& topic = dispatcher.topic(kind);
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
void report_segments(const ReorderBuffer& order, LogReport& report) {
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

/// Bag → router (which sensor is it?) → reorder buffer → dispatcher (decode, count) → sink. What the log lacks is
/// checked as early as the bag can tell, and again when all messages have been seen.
Result<LogReport> read_log(const std::string& path, const Rig& rig, SensorSink& sink, const LogOptions& options) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(BagReader bag, BagReader::open(path, options.bag));
  // A closed bag names its topics at once; there is no need to read gigabytes first.
  if (bag.summary().indexed && !bag.connections().empty()) {
    RAYFIELD_CHECK(check_present(path, rig, options, bag.connections()));
  }
  SensorDispatcher dispatcher(path, rig, sink);
  for (const SensorKind kind : kSensorKinds) dispatcher.topic(kind).topic = rig_topic(rig, kind).value_or("");
  TopicRouter router(path, rig);
  ReorderBuffer order(
      options, [&](SensorKind kind, const BufferedMessage& ordered) { return dispatcher.dispatch(kind, ordered); });
  BagMessage message;
  ReadProgress progress(options.progress);
  for (;;) {
    RAYFIELD_ASSIGN(const bool more, bag.next(message));
    if (!more) break;
    order.advance(message.record_time_ns);
    RAYFIELD_ASSIGN(const std::optional<SensorKind> kind, router.route(*message.connection, dispatcher));
    if (kind) {
      const std::int64_t stamp_ns = peek_ros_stamp(message.data).value_or(0);
      RAYFIELD_CHECK(order.add(*kind, stamp_ns, message.record_time_ns, message.offset, message.data));
    }
    if (!progress.advance(bag.position()))
      return fail(ErrorCode::interrupted, kWhat, path, "stopped by the user", "run the same command again");
  }
  RAYFIELD_CHECK(order.finish());
  LogReport report;
  for (const SensorKind kind : kSensorKinds) order.report(kind, dispatcher.topic(kind));
  if (bag.summary().messages == 0) {
    return fail(ErrorCode::bad_input, kWhat, path,
                "the bag holds no messages" +
                    (bag.summary().lost_bytes > 0 ? ": " + bag.summary().problems().back() : std::string()),
                "copy it from the vehicle again, or take another recording");
  }
  RAYFIELD_CHECK(check_present(path, rig, options, bag.connections()));
  RAYFIELD_CHECK(check_useful(path, rig, options, dispatcher));
  for (const SensorKind kind : kSensorKinds) report.topics[static_cast<std::size_t>(kind)] = dispatcher.topic(kind);
  report.bag = bag.summary();
  report.points = dispatcher.points();
  report.segment = options.segment;
  report_segments(order, report);
  return report;
}

}  // namespace rayfield::formats
