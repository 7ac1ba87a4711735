#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/console/beam_text.h"
#include "cli/console/text.h"
#include "cli/drives/drive_log.h"
#include "cli/scans/open_cloud.h"
#include "rayfield/core/date.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/formats/formats.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

// What a ray cloud holds: reads it once.
Result<Outcome> inspect_cloud(const std::string& path, const Context& context) {
  const auto cancelled = [&context] { return context.progress.cancelled(); };
  RAYFIELD_ASSIGN(
      const auto reader,
      formats::PlyReader::open(path, {.allow_truncated = true, .allow_trailing = true, .cancelled = cancelled}));
  context.progress.stage("reading", reader->ray_count().value_or(0), "rays");
  RayBatch batch;
  std::uint64_t rays = 0, hits = 0;
  double first = std::numeric_limits<double>::infinity(), last = -first;
  Eigen::AlignedBox3d origins, ends;
  while (true) {
    RAYFIELD_ASSIGN(const std::size_t count, reader->read(batch, 131072));
    if (count == 0) break;
    for (std::size_t i = 0; i < count; ++i) {
      hits += batch.hit[i];
      first = std::min(first, batch.time_s[i]), last = std::max(last, batch.time_s[i]);
      origins.extend(batch.origin[i]);
      if (batch.hit[i] != 0) ends.extend(batch.end[i]);
    }
    rays += count;
    context.progress.advance(count);
  }
  Outcome outcome;
  outcome.data = {
      {"path", path}, {"kind", "ray cloud"}, {"rays", rays}, {"hits", hits}, {"problems", reader->warnings()}};
  if (reader->crs()) outcome.data["crs"] = *reader->crs();
  outcome.text = fmt::format("{}: ray cloud, {} rays, {} hits\n", path, grouped(rays), grouped(hits));
  if (const auto beam = reader->beam()) {
    outcome.data["beam"] = beam_json(*beam);
    outcome.text += fmt::format("  beam: {}\n", beam_text(*beam));
  }
  if (rays > 0) {
    outcome.data["start_utc"] = utc_text(first), outcome.data["end_utc"] = utc_text(last);
    const auto box = [](const Eigen::AlignedBox3d& b) {
      return nlohmann::ordered_json{{"min", {b.min().x(), b.min().y(), b.min().z()}},
                                    {"max", {b.max().x(), b.max().y(), b.max().z()}}};
    };
    outcome.data["origins"] = box(origins);
    if (hits > 0) outcome.data["hit_extent"] = box(ends);
    outcome.text +=
        fmt::format("  from {} to {}\n  sensor between {:.1f} {:.1f} and {:.1f} {:.1f}\n", utc_text(first),
                    utc_text(last), origins.min().x(), origins.min().y(), origins.max().x(), origins.max().y());
  }
  for (const std::string& warning : reader->warnings()) outcome.text += fmt::format("  problem: {}\n", warning);
  return outcome;
}

// The times of a LAS file as far as it says when they are: seconds of a GPS week have no date.
void describe_times(const formats::LasInfo& info, Outcome& outcome) {
  outcome.data["clock"] = info.adjusted_gps_time ? "adjusted standard GPS time" : "seconds of the GPS week";
  outcome.data["first_gps_time_s"] = info.first_s, outcome.data["last_gps_time_s"] = info.last_s;
  outcome.text += fmt::format("  times {:.13g} to {:.13g}, {}\n", info.first_s, info.last_s,
                              outcome.data["clock"].get<std::string>());
  if (!info.start_unix_s) return;
  outcome.data["start_utc"] = utc_text(*info.start_unix_s), outcome.data["end_utc"] = utc_text(*info.end_unix_s);
  outcome.text += fmt::format("  from {} to {}\n", utc_text(*info.start_unix_s), utc_text(*info.end_unix_s));
}

// What a LAS cloud holds: reads it once, without a trajectory.
Result<Outcome> inspect_las_cloud(const std::string& path, const Context& context) {
  context.progress.stage("reading", 0, "points");
  RAYFIELD_ASSIGN(const formats::LasInfo info,
                  formats::inspect_las(
                      path, [&context] { return context.progress.cancelled(); },
                      [&context](std::uint64_t points) { context.progress.advance(points); }));
  Outcome outcome;
  outcome.data = {{"path", path},
                  {"kind", "LAS cloud"},
                  {"version", fmt::format("1.{}", info.minor_version)},
                  {"point_format", info.point_format},
                  {"points", info.points},
                  {"first_returns", info.first_returns},
                  {"left_out",
                   {{"later_returns", info.later_returns},
                    {"withheld", info.withheld},
                    {"synthetic", info.synthetic},
                    {"noise", info.noise},
                    {"without_time", info.not_finite}}},
                  {"problems", info.problems}};
  if (info.crs) outcome.data["crs"] = *info.crs;
  const std::uint64_t flagged = info.withheld + info.synthetic + info.noise + info.not_finite;
  outcome.text = fmt::format(
      "{}: LAS 1.{} cloud, {} points of format {}: {} first returns, {} later ones, {} withheld, synthetic, noise or "
      "without time\n",
      path, info.minor_version, grouped(info.points), info.point_format, grouped(info.first_returns),
      grouped(info.later_returns), grouped(flagged));
  outcome.text += fmt::format("  CRS: {}\n", info.crs ? info.crs_name : "none named");
  if (info.first_returns > 0) {
    describe_times(info, outcome);
    outcome.data["hit_extent"] = {{"min", {info.low.x(), info.low.y(), info.low.z()}},
                                  {"max", {info.high.x(), info.high.y(), info.high.z()}}};
    outcome.text += fmt::format("  points between {:.1f} {:.1f} {:.1f} and {:.1f} {:.1f} {:.1f}\n", info.low.x(),
                                info.low.y(), info.low.z(), info.high.x(), info.high.y(), info.high.z());
  }
  for (const std::string& problem : info.problems) outcome.text += fmt::format("  problem: {}\n", problem);
  outcome.text += "  `rayfield add` needs the path of its drive: --trajectory\n";
  return outcome;
}

// Width of the column of topics.
std::size_t topic_width(const formats::LogInfo& info) {
  std::size_t width = 20;
  for (const formats::TopicInfo& topic : info.topics) width = std::max(width, topic.topic.size());
  return std::min<std::size_t>(width, 60);
}

// What the ranges, the accelerometer and the fixes look like: enough to see a wrong unit or place at a glance.
void describe_sensors(const formats::LogInfo& info, Outcome& outcome) {
  using nlohmann::ordered_json;
  const std::size_t width = topic_width(info);
  for (const char* list : {"lidars", "imus", "gps"}) outcome.data[list] = ordered_json::array();
  for (const formats::LidarInfo& lidar : info.lidars) {
    const double none = static_cast<double>(lidar.nan + lidar.infinite + lidar.zero) /
                        static_cast<double>(std::max<std::uint64_t>(lidar.points, 1));
    outcome.data["lidars"].push_back({{"topic", lidar.topic},
                                      {"points_per_message", lidar.points_per_message},
                                      {"smallest_range_m", lidar.smallest_m},
                                      {"largest_range_m", lidar.largest_m},
                                      {"without_return", none}});
    outcome.text +=
        fmt::format("  {:<{}} {:.0f} points a message, ranges {:.2f} to {:.2f} m, {:.0f} % without a return\n",
                    lidar.topic, width, lidar.points_per_message, lidar.smallest_m, lidar.largest_m, 100 * none);
  }
  for (const formats::ImuInfo& imu : info.imus) {
    outcome.data["imus"].push_back({{"topic", imu.topic},
                                    {"mean_acceleration_m_s2", imu.mean_acceleration_m_s2},
                                    {"largest_rate_rad_s", imu.largest_rate_rad_s}});
    outcome.text += fmt::format("  {:<{}} mean acceleration {:.2f} m/s², fastest turn {:.2f} rad/s\n", imu.topic, width,
                                imu.mean_acceleration_m_s2, imu.largest_rate_rad_s);
  }
  for (const formats::GpsInfo& gps : info.gps) {
    const double latitude = (gps.south_deg + gps.north_deg) / 2, longitude = (gps.west_deg + gps.east_deg) / 2;
    const std::string utm = gps.fixes > 0 ? utm_code(latitude, longitude) : std::string();
    ordered_json entry = {{"topic", gps.topic}, {"fixes", gps.fixes}};
    if (gps.fixes > 0) {
      entry["south_west_deg"] = {gps.south_deg, gps.west_deg};
      entry["north_east_deg"] = {gps.north_deg, gps.east_deg};
      entry["utm"] = utm;
    }
    outcome.data["gps"].push_back(std::move(entry));
    outcome.text += gps.fixes > 0
                        ? fmt::format("  {:<{}} latitude {:.6f}, longitude {:.6f}, {:.0f} m; UTM zone {}\n", gps.topic,
                                      width, latitude, longitude, (gps.lowest_m + gps.highest_m) / 2, utm)
                        : fmt::format("  {:<{}} no fix\n", gps.topic, width);
  }
}

// What a log holds, its problems, and a rig file to start from.
Result<Outcome> inspect_drive_log(const std::string& path, const Context& context) {
  formats::LogOptions options;
  options.progress = &context.progress;
  context.progress.stage("reading log", 0, "bytes");
  RAYFIELD_ASSIGN(const formats::LogInfo info, formats::inspect_log(path, options));
  Outcome outcome;
  outcome.data = {{"path", path},
                  {"kind", "log"},
                  {"start_utc", utc_text(info.first_record_s)},
                  {"end_utc", utc_text(info.last_record_s)},
                  {"duration_s", info.duration_s},
                  {"topics", nlohmann::ordered_json::array()},
                  {"problems", info.problems()},
                  {"proposed_rig", formats::propose_rig(info)}};
  outcome.text = fmt::format("{}: log of {:.1f} s from {}\n", path, info.duration_s, utc_text(info.first_record_s));
  const std::size_t width = topic_width(info);
  for (const formats::TopicInfo& topic : info.topics) {
    outcome.data["topics"].push_back({{"topic", topic.topic},
                                      {"type", topic.type},
                                      {"messages", topic.messages},
                                      {"rate_hz", topic.rate_hz},
                                      {"longest_gap_s", topic.longest_gap_s},
                                      {"gaps", topic.gaps},
                                      {"clock_jumps", topic.clock_jumps},
                                      {"backwards", topic.backwards},
                                      {"repeated", topic.repeated}});
    outcome.text += fmt::format("  {:<{}} {:<26} {:>8} messages, {:.1f} Hz, longest gap {:.3f} s\n", topic.topic, width,
                                topic.type, topic.messages, topic.rate_hz, topic.longest_gap_s);
  }
  describe_sensors(info, outcome);
  for (const std::string& problem : info.problems()) outcome.text += fmt::format("  problem: {}\n", problem);
  outcome.text += "\nA rig file to start from:\n\n" + formats::propose_rig(info);
  return outcome;
}

Result<Outcome> run_info(const std::string& path, const Context& context) {
  if (std::filesystem::is_directory(path)) return store_status(path);
  if (is_log(path)) return inspect_drive_log(path, context);
  return is_las(path) ? inspect_las_cloud(path, context) : inspect_cloud(path, context);
}

}  // namespace

void add_info_command(Commands& commands) {
  const auto path = std::make_shared<std::string>();
  CLI::App* command = commands.add(
      "info",
      "What is in a log, a ray cloud or a store: counts, rates, gaps, extents, problems; proposes a rig file for a log",
      "rayfield info scan.ply", [path](Context& context) { return run_info(*path, context); });
  command->add_option("LOG|CLOUD|STORE", *path, "A log, a ray cloud, or the folder of a store")->required();
}

}  // namespace rayfield::cli
