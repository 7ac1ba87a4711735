#include "drive_log.h"

#include <fmt/core.h>

#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

struct OpenedLog {
  Rig rig;
  slam::LogReader read;
  std::vector<std::string> warnings;
};

// Reads the log once to learn its segments, and binds the longest.
Result<OpenedLog> open_log(const std::string& log, const std::string& rig_file, Progress& progress) {
  OpenedLog opened;
  RAYFIELD_ASSIGN(opened.rig, formats::read_rig(rig_file));
  progress.stage("reading log", 0, "bytes");
  formats::LogOptions options;
  options.progress = &progress;
  SensorSink nowhere;
  RAYFIELD_ASSIGN(const formats::LogReport report, formats::read_log(log, opened.rig, nowhere, options));
  opened.warnings = report.warnings();
  options.segment = report.longest_segment;
  options.progress = nullptr;
  opened.read = [log, rig = opened.rig, options](SensorSink& sink) -> Result<void> {
    RAYFIELD_CHECK(formats::read_log(log, rig, sink, options));
    return {};
  };
  return opened;
}

}  // namespace

bool is_log(const std::filesystem::path& path) { return path.extension() == ".bag"; }

Result<RegisteredDrive> register_drive(const std::string& log, const std::string& rig_file, const std::string& crs,
                                       int threads, Progress& progress) {
  RAYFIELD_ASSIGN(OpenedLog opened, open_log(log, rig_file, progress));
  slam::SlamOptions options;
  options.threads = threads;
  RAYFIELD_ASSIGN(slam::SlamResult result, slam::run_slam(opened.read, opened.rig, crs, options, progress));
  RegisteredDrive drive;
  drive.trajectory = std::make_shared<const slam::Trajectory>(std::move(result.trajectory));
  drive.report = std::move(result.report);
  drive.gps = std::move(result.gps);
  drive.log_warnings = std::move(opened.warnings);
  drive.rays = slam::open_unwarped(opened.read, opened.rig, drive.trajectory, result.offsets, log);
  return drive;
}

Result<RegisteredDrive> follow_trajectory(const std::string& log, const std::string& rig_file,
                                          const std::string& trajectory_file, const std::string& crs,
                                          Progress& progress) {
  RAYFIELD_ASSIGN(OpenedLog opened, open_log(log, rig_file, progress));
  RAYFIELD_ASSIGN(formats::Trajectory given, formats::read_trajectory(trajectory_file));
  if (!crs.empty() && !given.crs.empty() && given.crs != crs)
    return fail(ErrorCode::usage, "cannot use trajectory", trajectory_file,
                fmt::format("it is in {}, not in {}", given.crs, crs), "transform it");
  RAYFIELD_ASSIGN(slam::Trajectory trajectory,
                  slam::make_trajectory(std::move(given.poses), crs.empty() ? given.crs : crs));
  RegisteredDrive drive;
  drive.trajectory = std::make_shared<const slam::Trajectory>(std::move(trajectory));
  drive.log_warnings = std::move(opened.warnings);
  drive.rays = slam::open_unwarped(opened.read, opened.rig, drive.trajectory, {}, log);
  return drive;
}

}  // namespace rayfield::cli
