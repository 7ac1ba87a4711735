#include <fmt/core.h>

#include <fstream>
#include <memory>

#include "drive_log.h"
#include "drive_picture.h"
#include "rayfield/formats/formats.h"
#include "text.h"
#include "verbs.h"

namespace rayfield::cli {
namespace {

struct SlamArguments {
  std::string log, rig, crs, cloud, trajectory, report, picture, given;
};

Result<void> write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file)
    return fail(ErrorCode::resources, "cannot write report", path, "the file was not taken",
                "check folder, space and permission");
  return {};
}

// Streams the rays into the cloud; counts them in plan for the picture.
Result<std::uint64_t> write_rays(RegisteredDrive& drive, const SlamArguments& arguments, Grid2<std::uint32_t>& hits,
                                 Progress& progress) {
  RAYFIELD_ASSIGN(formats::PlyWriter cloud, formats::PlyWriter::create(arguments.cloud, {drive.trajectory->crs}));
  progress.stage("rays", 0, "rays");
  RayBatch batch;
  while (true) {
    RAYFIELD_ASSIGN(const std::size_t count, drive.rays->read(batch, 65536));
    if (count == 0) break;
    RAYFIELD_CHECK(cloud.write(batch));
    if (hits.nx > 0) slam::add_hits(hits, batch);
    progress.advance(count);
    if (progress.cancelled())
      return fail(ErrorCode::interrupted, "interrupted", arguments.cloud, "", "run the same command again");
  }
  RAYFIELD_CHECK(cloud.close());
  return cloud.ray_count();
}

Result<Outcome> run_slam_verb(const SlamArguments& arguments, const Context& context) {
  Outcome outcome;
  if (context.options.dry_run) {
    RAYFIELD_CHECK(formats::read_rig(arguments.rig));
    outcome.data = {{"log", arguments.log}, {"dry_run", true}};
    outcome.text = fmt::format("Would register {}\n", arguments.log);
    return outcome;
  }
  if (std::filesystem::exists(arguments.cloud) && !context.options.overwrite)
    return fail(ErrorCode::usage, "cannot write ray cloud", arguments.cloud, "it is there already",
                "give another -o, or --overwrite");
  auto registered =
      arguments.given.empty()
          ? register_drive(arguments.log, arguments.rig, arguments.crs, context.options.threads, context.progress)
          : follow_trajectory(arguments.log, arguments.rig, arguments.given, arguments.crs, context.progress);
  if (!registered) return tl::make_unexpected(std::move(registered).error());
  RegisteredDrive& drive = *registered;
  Grid2<std::uint32_t> hits;
  if (!arguments.picture.empty()) hits = slam::plan_grid(*drive.trajectory, 15.0, 0.1);
  RAYFIELD_ASSIGN(const std::uint64_t rays, write_rays(drive, arguments, hits, context.progress));
  if (!arguments.trajectory.empty())
    RAYFIELD_CHECK(
        formats::write_trajectory(arguments.trajectory, {drive.trajectory->poses, drive.trajectory->crs, "IMU"}));
  if (!arguments.report.empty()) RAYFIELD_CHECK(write_text(arguments.report, slam::report_json(drive.report) + "\n"));
  if (!arguments.picture.empty()) RAYFIELD_CHECK(write_drive_picture(drive, hits, arguments.picture));

  std::vector<std::string> warnings = drive.log_warnings;
  for (const std::string& warning : drive.rays->warnings()) warnings.push_back(warning);
  for (const std::string& warning : warnings) context.progress.warn(warning);
  outcome.data = {{"log", arguments.log},
                  {"cloud", arguments.cloud},
                  {"rays", rays},
                  {"crs", drive.trajectory->crs},
                  {"warnings", warnings}};
  if (arguments.given.empty()) outcome.data["report"] = nlohmann::ordered_json::parse(slam::report_json(drive.report));
  outcome.text = (arguments.given.empty() ? slam::report_summary(drive.report) : "") +
                 fmt::format("{}: {} rays\n", arguments.cloud, grouped(rays));
  return outcome;
}

}  // namespace

void add_slam_verb(Commands& commands) {
  const auto arguments = std::make_shared<SlamArguments>();
  CLI::App* command =
      commands.add("slam", "Register a log: from lidar, IMU and GPS to a georeferenced ray cloud",
                   "rayfield slam scan.bag --rig rig.toml --crs EPSG:7854 -o scan.ply --report scan.json",
                   [arguments](Context& context) { return run_slam_verb(*arguments, context); });
  command->add_option("LOG", arguments->log, "ROS 1 bag")->required();
  command->add_option("--rig", arguments->rig, "Rig file (docs/rig.md)")->required();
  command->add_option("--crs", arguments->crs, "Projected CRS of the ray cloud (default: a local frame)");
  command->add_option("-o,--output", arguments->cloud, "Ray cloud to write (raycloudtools PLY)")->required();
  command->add_option("--trajectory", arguments->trajectory, "Write the trajectory (TUM text)");
  command->add_option("--report", arguments->report, "Write the quality report (JSON)");
  command->add_option("--picture", arguments->picture, "Write a plan view of trajectory, GPS and point density (PNG)");
  command->add_option("--use-trajectory", arguments->given,
                      "Do not estimate: take this trajectory (TUM text of the IMU frame)");
}

}  // namespace rayfield::cli
