#include "rayfield/formats/sensor_log_report.h"

#include <fmt/format.h>

#include <utility>

#include "formats/sensor_log/coverage.h"
#include "formats/sensor_log/sensor_topics.h"
#include "rayfield/core/date.h"

namespace rayfield::formats {
namespace {

/// Share of invalid points from which canopies would come out too dense: the sky is missing.
constexpr double kManyInvalid = 0.1;
/// Share of zero ranges from which the rig's no_return looks wrong: sensors hardly ever measure exactly 0.
constexpr double kManyZeros = 0.01;

void add_topic_warnings(const TopicReport& topic, SensorKind kind, std::vector<std::string>& lines) {
  const auto line = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) lines.push_back(fmt::format("{} {}: {} {}", sensor_name(kind), topic.topic, count, what));
  };
  if (!topic.topic.empty() && topic.messages == 0) {
    lines.push_back(fmt::format("{} {}: no messages", sensor_name(kind), topic.topic));
  }
  line(topic.duplicates, "messages twice in the log, left out once");
  line(topic.reordered, "messages out of order");
  line(topic.late, "of those too late to be put back in order, left out");
  line(topic.stray_stamps, "messages with a stray time stamp left out");
  line(topic.without_stamp, "messages without a time stamp: recording time taken");
  line(topic.undecodable, "malformed messages left out");
  line(topic.invalid - topic.without_position, "messages without a valid value left out");
  line(topic.without_position, "messages without a fix left out");
}

/// How long a sensor may be silent, or begin or end apart from the others, without a word.
double tolerated_silence_s(SensorKind kind) {
  switch (kind) {
    case SensorKind::imu:
      return 0.5;
    case SensorKind::gps:
      return 5.0;
    case SensorKind::spinner:
    case SensorKind::lidar:
      break;
  }
  return 1.0;
}

void add_silences(const LogReport& report, std::vector<std::string>& lines) {
  std::vector<SensorSpan> spans;
  for (const SensorKind kind : kSensorKinds) {
    const TopicReport& topic = report.topic(kind);
    if (topic.delivered == 0) continue;
    const std::string name = fmt::format("{} {}", sensor_name(kind), topic.topic);
    spans.push_back({name, topic.first_s, topic.last_s, tolerated_silence_s(kind)});
    if (topic.longest_gap_s > tolerated_silence_s(kind)) {
      lines.push_back(fmt::format("{}: silent for {:.1f} s from {}", name, topic.longest_gap_s,
                                  utc_text(topic.longest_gap_start_s)));
    }
    if (topic.longest_stationary_s > tolerated_silence_s(kind)) {
      lines.push_back(fmt::format("{}: stands still for {:.1f} s from {}", name, topic.longest_stationary_s,
                                  utc_text(topic.longest_stationary_start_s)));
    }
  }
  for (std::string& line : coverage_problems(spans)) lines.push_back(std::move(line));
}

/// Which part of a log with clock jumps is used.
void add_segments(const LogReport& report, std::vector<std::string>& lines) {
  const std::size_t count = report.segments.size(), used = static_cast<std::size_t>(report.segment);
  if (count < 2 || used >= count) return;
  const auto length_s = [&](std::size_t i) { return report.segments[i].last_s - report.segments[i].first_s; };
  double others_s = 0;
  for (std::size_t i = 0; i < count; ++i) others_s += i == used ? 0.0 : length_s(i);
  lines.push_back(
      fmt::format("the clock jumps {}: of {} segments number {} is used, {:.1f} s from {} to {}; the others, {:.1f} s, "
                  "are left out",
                  count == 2 ? "once" : fmt::format("{} times", count - 1), count, used + 1, length_s(used),
                  utc_text(report.segments[used].first_s), utc_text(report.segments[used].last_s), others_s));
}

}  // namespace

std::vector<std::string> LogReport::warnings() const {
  std::vector<std::string> lines = bag.problems();
  for (const SensorKind kind : kSensorKinds) add_topic_warnings(topic(kind), kind, lines);
  add_silences(*this, lines);
  add_segments(*this, lines);
  const auto share_of = [&](std::uint64_t count) {
    return points.points == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(points.points);
  };
  if (points.later_echoes > 0) {
    lines.push_back(fmt::format(
        "the lidar reports several echoes of a beam: the first of each is taken, {} later ones are left out",
        points.later_echoes));
  }
  if (points.without_direction > 0) {
    lines.push_back(
        fmt::format("{} points ({:.1f} %) at the sensor's origin left out: their direction is unknown, so "
                    "they do not count as seen empty",
                    points.without_direction, 100 * share_of(points.without_direction)));
  } else if (share_of(points.zeros) > kManyZeros && points.too_close >= points.zeros) {
    lines.push_back(
        fmt::format("{:.1f} % of the ranges are exactly 0: if that means nothing came back, set "
                    "no_return = \"zero\" in the rig file",
                    100 * share_of(points.zeros)));
  }
  if (share_of(points.invalid) > kManyInvalid) {
    lines.push_back(
        fmt::format("{:.1f} % of the lidar's points are NaN or have an impossible time and are left out: they do not "
                    "count as seen empty",
                    100 * share_of(points.invalid)));
  }
  return lines;
}

}  // namespace rayfield::formats
