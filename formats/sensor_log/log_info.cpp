#include "rayfield/formats/log_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "formats/rosbag/point_cloud2.h"
#include "formats/rosbag/ros_decode.h"
#include "formats/rosbag/ros_definitions.h"
#include "formats/sensor_log/coverage.h"
#include "formats/sensor_log/log_statistics.h"
#include "formats/sensor_log/read_progress.h"
#include "formats/sensor_log/sensor_topics.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot inspect log";

/// Statistics of one topic; those of a sensor exist where the type is one that rayfield reads.
struct TopicStatistics {
  explicit TopicStatistics(const BagConnection& connection) {
    info.topic = connection.topic;
    info.type = connection.type;
    info.raw_packets = is_raw_packets(connection.type);
    const RosDefinition* known = find_ros_definition(connection.type);
    const bool standard = known != nullptr && (connection.md5sum == "*" || connection.md5sum == known->md5sum);
    // Any type that begins with a std_msgs/Header has a stamp where we look for it.
    info.has_stamps = standard || connection.definition.starts_with("Header header") ||
                      connection.definition.starts_with("std_msgs/Header header");
    if (!standard) return;
    if (serves(connection.type, SensorKind::lidar)) lidar.emplace(connection.topic);
    if (serves(connection.type, SensorKind::imu)) imu.emplace(connection.topic);
    if (serves(connection.type, SensorKind::gps)) gps.emplace(connection.topic);
    if (serves(connection.type, SensorKind::spinner)) joints.emplace(connection.topic);
  }

  void add(const BagMessage& message, std::int64_t log_clock_ns, const LogOptions& options) {
    std::int64_t time_ns = message.record_time_ns;
    if (info.has_stamps) {
      ByteCursor cursor(message.data);
      const RosHeader header = take_ros_header(cursor);
      if (!cursor.failed() && header.stamp_ns == 0) ++info.unstamped;
      if (!cursor.failed() && header.stamp_ns != 0) time_ns = header.stamp_ns;
      if (!cursor.failed() && !seen_frame) info.frame_id = header.frame_id.substr(0, 256);
      seen_frame = true;
    }
    stamps.add(time_ns, log_clock_ns, options);
    if (!add_sensor(message.data, seconds_from_ns(time_ns))) ++info.undecodable;
  }

  bool add_sensor(std::span<const std::byte> data, double time_s) {
    const auto add_to = [](auto& statistics, const auto& decoded) {
      if (decoded) statistics->add(*decoded);
      return decoded.has_value();
    };
    if (imu) return add_to(imu, decode_imu(data));
    if (gps) return add_to(gps, decode_nav_sat_fix(data));
    if (joints) {
      const auto state = decode_joint_state(data);
      if (state) joints->add(*state, time_s);
      return state.has_value();
    }
    if (!lidar) return true;
    if (info.type == laser_scan_definition().type) return add_to(lidar, decode_laser_scan(data));
    if (info.type == multi_echo_laser_scan_definition().type) return add_to(lidar, decode_multi_echo_laser_scan(data));
    return add_to(lidar, decode_point_cloud2(data));
  }

  TopicInfo info;
  bool seen_frame = false;
  StampStatistics stamps;
  std::optional<LidarStatistics> lidar;
  std::optional<ImuStatistics> imu;
  std::optional<GpsStatistics> gps;
  std::optional<JointStatistics> joints;
};

/// The recording's own clock: how long it ran, jumps taken out.
struct RecordClock {
  std::int64_t last_ns = 0, passed_ns = 0, first_ns = 0, latest_ns = 0;
  std::uint64_t jumps = 0;
  bool started = false;

  void advance(std::int64_t time_ns, const LogOptions& options) {
    const std::int64_t step = started ? time_ns - last_ns : 0;
    const double step_s = static_cast<double>(step) * 1e-9;
    if (step_s < -options.clock_jump_back_s || step_s > options.clock_jump_forward_s)
      ++jumps;
    else if (step > 0)
      passed_ns += step;
    first_ns = started ? std::min(first_ns, time_ns) : time_ns;
    latest_ns = started ? std::max(latest_ns, time_ns) : time_ns;
    last_ns = time_ns;
    started = true;
  }
};

std::string times_text(std::uint64_t count) { return count == 1 ? "once" : fmt::format("{} times", count); }

void add_topic_problems(const TopicInfo& topic, std::vector<std::string>& lines) {
  const auto line = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) lines.push_back(fmt::format("{}: {} {}", topic.topic, count, what));
  };
  if (topic.raw_packets) {
    lines.push_back(fmt::format("{}: a sensor's raw packets ({}): {}", topic.topic, topic.type, kDecodeRawPackets));
  }
  if (topic.gaps > 0) {
    lines.push_back(fmt::format("{}: {} gaps, the longest {:.3f} s", topic.topic, topic.gaps, topic.longest_gap_s));
  }
  if (topic.clock_jumps > 0) {
    lines.push_back(fmt::format("{}: its clock jumps {}", topic.topic, times_text(topic.clock_jumps)));
  }
  line(topic.backwards, "stamps earlier than the one before");
  line(topic.repeated, "stamps equal to the one before");
  line(topic.unstamped, "messages without a stamp");
  line(topic.undecodable, "malformed messages");
}

/// A spinner that stops, or joints of which none goes round.
void add_joint_problems(const LogInfo& info, std::vector<std::string>& lines) {
  constexpr double kTolerated_s = 1.0;
  bool turns = false;
  for (const JointInfo& joint : info.joints) {
    turns = turns || joint.turns();
    if (joint.turns() && joint.longest_stationary_s > kTolerated_s) {
      lines.push_back(fmt::format("{}: joint '{}' stands still for {:.1f} s", joint.topic, joint.joint,
                                  joint.longest_stationary_s));
    }
  }
  if (turns || info.joints.empty()) return;
  lines.push_back(fmt::format("{}: no joint goes round: '{}' turns by {:.2f} rad in all; a spinner would be stuck",
                              info.joints.front().topic, info.joints.front().joint, info.joints.front().travelled_rad));
}

/// Sensors that begin or end apart from the others. Clock jumps make spans meaningless.
void add_coverage_problems(const LogInfo& info, std::vector<std::string>& lines) {
  constexpr double kGps_s = 5.0;
  std::vector<SensorSpan> spans;
  for (const SensorKind kind : {SensorKind::imu, SensorKind::lidar, SensorKind::spinner, SensorKind::gps}) {
    for (const TopicInfo& topic : info.topics) {
      if (topic.clock_jumps > 0) return;
      if (topic.messages == 0 || !serves(topic.type, kind)) continue;
      spans.push_back({topic.topic, topic.first_s, topic.last_s, kind == SensorKind::gps ? kGps_s : 1.0});
    }
  }
  for (std::string& line : coverage_problems(spans)) lines.push_back(std::move(line));
}

/// What the values of the sensors give away: missing times, units that are wrong, sensors that saw nothing.
void add_sensor_problems(const LogInfo& info, std::vector<std::string>& lines) {
  constexpr double kImplausible_rad_s = 10;  // of a vehicle between vines
  for (const LidarInfo& lidar : info.lidars) {
    if (!lidar.has_point_time) {
      lines.push_back(fmt::format("{}: no time per point (fields: {})", lidar.topic, lidar.fields));
    }
    if (lidar.time_increment_s == 0.0) {
      lines.push_back(fmt::format("{}: time_increment is 0, all beams of a scan share one time", lidar.topic));
    }
    if (lidar.points > 0 && lidar.nan == lidar.points) {
      lines.push_back(lidar.topic + ": every range is NaN");
    } else if (lidar.points > 0 && lidar.largest_m == 0) {
      lines.push_back(lidar.topic + ": not one return");
    }
  }
  for (const ImuInfo& imu : info.imus) {
    const double g = imu.mean_acceleration_m_s2;
    if (g > 0 && (g < 8.8 || g > 10.8)) {
      lines.push_back(fmt::format("{}: the mean acceleration is {:.2f}, not the 9.8 m/s2 of gravity", imu.topic, g));
    }
    if (imu.largest_rate_rad_s > kImplausible_rad_s) {
      lines.push_back(fmt::format("{}: the fastest turn is {:.0f} rad/s, as if the gyroscope were in degrees",
                                  imu.topic, imu.largest_rate_rad_s));
    }
    if (imu.invalid > 0) lines.push_back(fmt::format("{}: {} samples with NaN", imu.topic, imu.invalid));
  }
  add_joint_problems(info, lines);
  for (const GpsInfo& gps : info.gps) {
    if (gps.without_fix > 0) lines.push_back(fmt::format("{}: {} messages without a fix", gps.topic, gps.without_fix));
  }
  if (info.lidars.empty()) lines.push_back("no lidar (sensor_msgs/LaserScan, MultiEchoLaserScan or PointCloud2)");
  if (info.imus.empty()) lines.push_back("no IMU (sensor_msgs/Imu)");
  if (info.gps.empty()) lines.push_back("no GPS (sensor_msgs/NavSatFix): nothing can be georeferenced");
}

}  // namespace

std::vector<std::string> LogInfo::problems() const {
  std::vector<std::string> lines = bag.problems();
  if (bag.messages == 0) lines.push_back("the bag holds no messages");
  if (record_clock_jumps > 0)
    lines.push_back(fmt::format("the recording's clock jumps {}", times_text(record_clock_jumps)));
  for (const TopicInfo& topic : topics) add_topic_problems(topic, lines);
  add_coverage_problems(*this, lines);
  add_sensor_problems(*this, lines);
  return lines;
}

/// One pass over the messages; the statistics of each topic take constant memory.
Result<LogInfo> inspect_log(const std::string& path, const LogOptions& options) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(BagReader bag, BagReader::open(path, options.bag));
  // By topic and type: several publishers of one topic are one topic.
  std::map<std::pair<std::string, std::string>, TopicStatistics> topics;
  const auto statistics_of = [&](const BagConnection& connection) -> TopicStatistics& {
    return topics.try_emplace({connection.topic, connection.type}, connection).first->second;
  };
  RecordClock clock;
  BagMessage message;
  ReadProgress progress(options.progress);
  const BagConnection* last_connection = nullptr;
  TopicStatistics* topic = nullptr;
  for (;;) {
    RAYFIELD_ASSIGN(const bool more, bag.next(message));
    if (!more) break;
    clock.advance(message.record_time_ns, options);
    if (message.connection != last_connection) topic = &statistics_of(*message.connection);
    last_connection = message.connection;
    topic->add(message, clock.passed_ns, options);
    if (!progress.advance(bag.position()))
      return fail(ErrorCode::interrupted, kWhat, path, "stopped by the user", "run the same command again");
  }
  for (const BagConnection& connection : bag.connections()) statistics_of(connection);
  LogInfo info;
  info.bag = bag.summary();
  info.first_record_s = seconds_from_ns(clock.first_ns);
  info.last_record_s = seconds_from_ns(clock.latest_ns);
  info.duration_s = seconds_from_ns(clock.passed_ns);
  info.record_clock_jumps = clock.jumps;
  for (auto& [key, each] : topics) {
    each.stamps.report(each.info);
    info.topics.push_back(each.info);
    if (each.info.messages == 0) continue;
    if (each.lidar) info.lidars.push_back(each.lidar->report());
    if (each.imu) info.imus.push_back(each.imu->report());
    if (each.gps) info.gps.push_back(each.gps->report());
    if (!each.joints) continue;
    for (JointInfo& joint : each.joints->report()) info.joints.push_back(std::move(joint));
  }
  return info;
}

}  // namespace rayfield::formats
