#include <fmt/format.h>

#include "rayfield/core/date.h"
#include "rayfield/formats/sensor_log.h"
#include "sensor_topics.h"

namespace rayfield::formats {
namespace {

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
  line(topic.other_segments, "messages in other segments of the log left out");
  line(topic.undecodable, "malformed messages left out");
  line(topic.invalid - topic.without_position, "messages without a valid value left out");
  line(topic.without_position, "messages without a fix left out");
}

}  // namespace

std::vector<std::string> LogReport::warnings() const {
  std::vector<std::string> lines = bag.problems();
  for (const SensorKind kind : kSensorKinds) add_topic_warnings(topic(kind), kind, lines);
  if (segments.size() > 1) {
    lines.push_back(fmt::format("the clock jumps {} times; the longest of the {} segments is number {}",
                                segments.size() - 1, segments.size(), longest_segment));
    constexpr std::size_t kListed = 10;
    for (std::size_t i = 0; i < segments.size() && i < kListed; ++i) {
      lines.push_back(fmt::format("segment {}: {} to {}, {:.1f} s, {} messages", i, utc_text(segments[i].first_s),
                                  utc_text(segments[i].last_s), segments[i].last_s - segments[i].first_s,
                                  segments[i].messages));
    }
  }
  const auto share_of = [&](std::uint64_t count) {
    return points.points == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(points.points);
  };
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
  return lines;
}

}  // namespace rayfield::formats
