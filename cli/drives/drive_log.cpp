#include "cli/drives/drive_log.h"

#include <fmt/core.h>

#include <cmath>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <optional>

#include "rayfield/core/file.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/core/median.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

// Where the drive took place: the median fix, as receivers may begin with nonsense.
class Place : public SensorSink {
 public:
  void gps(const GpsFix& fix) override {
    latitude_deg_.push_back(fix.latitude_deg);
    longitude_deg_.push_back(fix.longitude_deg);
  }
  std::optional<Eigen::Vector3d> position() {
    if (latitude_deg_.empty()) return std::nullopt;
    return Eigen::Vector3d(median_of(latitude_deg_), median_of(longitude_deg_), 0);
  }

 private:
  std::vector<double> latitude_deg_, longitude_deg_;
};

// An error that names no file gets the log's: several may be given.
Error with_log(Error error, const std::string& log) {
  if (error.where.find(log) == std::string::npos)
    error.where = error.where.empty() || error.where == "log" ? log : log + ", " + error.where;
  if (error.code == ErrorCode::interrupted && error.next.empty()) error.next = "run the same command again";
  return error;
}

// Why nothing can be georeferenced; empty where there are fixes.
std::string missing_position(const OpenedLog& opened) {
  if (!opened.rig.gps) return "the rig has no GPS";
  if (opened.report.topic(formats::SensorKind::gps).delivered > 0) return {};
  return "the log has no usable GPS fix on " + opened.rig.gps->topic;
}

}  // namespace

bool is_log(const std::filesystem::path& path) {
  std::string name = path.filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const char* ending : {".bag", ".bag.active", ".db3", ".mcap"})
    if (name.ends_with(ending)) return true;
  constexpr std::string_view kMagic = "#ROSBAG V";
  std::array<std::byte, kMagic.size()> head{};
  const auto file = open_regular_file(path.string(), "cannot read");
  if (!file || !read_at(file->descriptor, 0, head, "cannot read", path.string())) return false;
  return std::memcmp(head.data(), kMagic.data(), kMagic.size()) == 0;
}

Result<OpenedLog> open_log(const std::string& log, const std::string& rig_file, const std::string& crs,
                           Progress& progress) {
  OpenedLog opened;
  RAYFIELD_ASSIGN(opened.rig, formats::read_rig(rig_file));
  progress.stage("reading log", 0, "bytes");
  formats::LogOptions options;
  options.progress = &progress;
  Place place;
  RAYFIELD_ASSIGN(opened.report, formats::read_log(log, opened.rig, place, options));
  if (opened.report.longest_segment != 0) {
    options.segment = opened.report.longest_segment;
    place = {};
    RAYFIELD_ASSIGN(opened.report, formats::read_log(log, opened.rig, place, options));
  }
  if (const auto position = place.position(); position && !crs.empty()) RAYFIELD_CHECK(check_crs_suits(crs, *position));
  if (opened.report.points.later_echoes > 0 && opened.rig.lidar.beam)
    opened.rig.lidar.beam->returns = ReturnMode::first;
  opened.warnings = opened.report.warnings();
  if (const std::string gap = missing_position(opened); !gap.empty())
    opened.warnings.push_back("nothing is georeferenced: " + gap);
  for (const std::string& warning : opened.warnings) progress.warn(warning);
  options.progress = nullptr;
  opened.read = [log, rig = opened.rig, options](SensorSink& sink) -> Result<void> {
    RAYFIELD_CHECK(formats::read_log(log, rig, sink, options));
    return {};
  };
  return opened;
}

Result<RegisteredDrive> register_drive(const std::string& log, const std::string& rig_file, const std::string& crs,
                                       bool require_gps, const slam::SlamOptions& options, Progress& progress) {
  RAYFIELD_ASSIGN(OpenedLog opened, open_log(log, rig_file, crs, progress));
  const std::string gap = missing_position(opened);
  if (require_gps && !gap.empty())
    return fail(ErrorCode::bad_input, "cannot georeference log", log, gap,
                "maps need GPS; `rayfield slam` makes a ray cloud in a local frame");
  auto registered = slam::run_slam(opened.read, opened.rig, crs, options, progress);
  if (!registered) return tl::make_unexpected(with_log(std::move(registered).error(), log));
  slam::SlamResult& result = *registered;
  // With fixes and a CRS a cloud in the map was asked for, and a vehicle that stood still cannot give one.
  const bool asked_for = require_gps || (!crs.empty() && gap.empty());
  if (asked_for && !result.report.georeferenced)
    return fail(ErrorCode::bad_input, "cannot georeference log", log, result.report.frame_note,
                "maps need a drive; without --crs `rayfield slam` makes a ray cloud in a local frame");
  RegisteredDrive drive;
  drive.trajectory = std::make_shared<const slam::Trajectory>(std::move(result.trajectory));
  drive.report = std::move(result.report);
  drive.gps = std::move(result.gps);
  drive.beam = opened.rig.lidar.beam;
  if (drive.beam && std::isfinite(drive.report.range_resolution_m))
    drive.beam->range_resolution_m = drive.report.range_resolution_m;
  drive.log_warnings = std::move(opened.warnings);
  drive.rays = slam::open_unwarped(opened.read, opened.rig, drive.trajectory, result.offsets, log);
  return drive;
}

Result<RegisteredDrive> follow_trajectory(const std::string& log, const std::string& rig_file,
                                          const std::string& trajectory_file, const std::string& crs,
                                          Progress& progress) {
  RAYFIELD_ASSIGN(OpenedLog opened, open_log(log, rig_file, crs, progress));
  RAYFIELD_ASSIGN(formats::TrajectoryFile given, formats::read_trajectory(trajectory_file));
  if (!given.has_orientation)
    return fail(ErrorCode::bad_input, "cannot use trajectory", trajectory_file, "it has no orientations",
                "give one with qx qy qz qw");
  if (!crs.empty() && !given.crs.empty() && !same_crs(given.crs, crs))
    return fail(ErrorCode::usage, "cannot use trajectory", trajectory_file,
                fmt::format("it is in {}, not in {}", given.crs, crs), "transform it");
  RAYFIELD_ASSIGN(slam::Trajectory trajectory,
                  slam::make_trajectory(std::move(given.poses), crs.empty() ? given.crs : crs));
  RegisteredDrive drive;
  drive.trajectory = std::make_shared<const slam::Trajectory>(std::move(trajectory));
  drive.beam = opened.rig.lidar.beam;
  drive.log_warnings = std::move(opened.warnings);
  drive.rays = slam::open_unwarped(opened.read, opened.rig, drive.trajectory, {}, log);
  return drive;
}

std::vector<std::string> all_warnings(const RegisteredDrive& drive) {
  std::vector<std::string> all = drive.log_warnings;
  for (const std::string& warning : drive.report.warnings) all.push_back(warning);
  if (drive.rays)
    for (const std::string& warning : drive.rays->warnings()) all.push_back(warning);
  return all;
}

}  // namespace rayfield::cli
