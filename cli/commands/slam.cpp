#include <fmt/core.h>

#include <array>
#include <memory>
#include <vector>

#include "cli/commands/commands.h"
#include "cli/console/option_settings.h"
#include "cli/console/output_paths.h"
#include "cli/console/text.h"
#include "cli/drives/drive_log.h"
#include "cli/drives/drive_needs.h"
#include "cli/drives/drive_picture.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

struct SlamArguments {
  std::string log, rig, crs, cloud, trajectory, report, picture, given;
  std::vector<std::string> settings;
};

std::vector<OutputPath> outputs_of(const SlamArguments& arguments) {
  std::vector<OutputPath> outputs{{"-o", "cannot write ray cloud", arguments.cloud}};
  for (const auto& [option, what, path] : {std::tuple("--trajectory", "cannot write trajectory", &arguments.trajectory),
                                           std::tuple("--report", "cannot write report", &arguments.report),
                                           std::tuple("--picture", "cannot write picture", &arguments.picture)})
    if (!path->empty()) outputs.push_back({option, what, *path});
  return outputs;
}

Result<void> check_paths(const SlamArguments& arguments, bool overwrite) {
  const std::array<std::string, 3> inputs{arguments.log, arguments.rig, arguments.given};
  return check_outputs(outputs_of(arguments), inputs, overwrite);
}

// What --dry-run says: reads the log once, as the run would, and bounds what the cloud will take.
Result<Outcome> describe_slam(const SlamArguments& arguments, Progress& progress) {
  RAYFIELD_ASSIGN(const OpenedLog log, open_log(arguments.log, arguments.rig, arguments.crs, progress));
  Outcome outcome;
  outcome.data = {{"log", arguments.log},
                  {"cloud", arguments.cloud},
                  {"dry_run", true},
                  {"rays_at_most", rays_of(log)},
                  {"warnings", log.warnings}};
  outcome.text = fmt::format("Would register {} and write up to {} rays to {}\n", arguments.log, grouped(rays_of(log)),
                             arguments.cloud);
  add_needs(slam_needs(log), std::filesystem::path(arguments.cloud).parent_path(), outcome);
  return outcome;
}

// Streams the rays into the cloud, which is not there yet under its name; counts them in plan for the picture.
Result<formats::PlyWriter> write_rays(RegisteredDrive& drive, const SlamArguments& arguments,
                                      Grid2<std::uint32_t>& hits, Progress& progress) {
  // A cloud in a local frame says so, lest it be added to a store as if it were in the store's CRS.
  const std::string& crs = drive.trajectory->crs;
  RAYFIELD_ASSIGN(formats::PlyWriter cloud,
                  formats::PlyWriter::create(arguments.cloud, {crs.empty() ? kLocalFrame : crs, drive.beam}));
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
  if (cloud.ray_count() == 0)
    return fail(ErrorCode::bad_input, "cannot make a ray cloud", arguments.log,
                "none of its rays was measured while the trajectory lasts", "give the trajectory of this log");
  return cloud;
}

std::filesystem::path scratch_beside(const std::string& output) {
  const std::filesystem::path folder = std::filesystem::path(output).parent_path();
  return folder.empty() ? "." : folder;
}

// Paths, CRS and options are checked before the log is read. The cloud is streamed, and
// appears last: where it is, so is all the rest.
Result<Outcome> run_slam_command(const SlamArguments& arguments, const Context& context) {
  RAYFIELD_CHECK(check_paths(arguments, context.options.overwrite));
  if (!arguments.crs.empty()) RAYFIELD_CHECK(lookup_projected_crs(arguments.crs));
  RAYFIELD_CHECK(formats::PlyWriteOptions{arguments.crs}.validate());
  slam::SlamOptions options;
  options.threads = context.options.threads;
  options.scratch = scratch_beside(arguments.cloud).string();
  RAYFIELD_CHECK(apply_settings(arguments.settings, options));
  RAYFIELD_CHECK(options.validate());
  if (context.options.dry_run) return describe_slam(arguments, context.progress);
  RAYFIELD_ASSIGN(NewOutputs outputs, NewOutputs::hold(outputs_of(arguments)));
  RAYFIELD_CHECK(check_paths(arguments, context.options.overwrite));  // who held them may have ended meanwhile
  auto registered =
      arguments.given.empty()
          ? register_drive(arguments.log, arguments.rig, arguments.crs, false, options, context.progress)
          : follow_trajectory(arguments.log, arguments.rig, arguments.given, arguments.crs, context.progress);
  if (!registered) return tl::make_unexpected(std::move(registered).error());
  RegisteredDrive& drive = *registered;
  Grid2<std::uint32_t> hits;
  if (!arguments.picture.empty()) hits = slam::plan_grid(*drive.trajectory, 15.0, 0.1);
  RAYFIELD_ASSIGN(formats::PlyWriter cloud, write_rays(drive, arguments, hits, context.progress));
  if (!arguments.trajectory.empty())
    RAYFIELD_CHECK(
        formats::write_trajectory(arguments.trajectory, {drive.trajectory->poses, drive.trajectory->crs, "IMU"}));
  if (!arguments.report.empty())
    RAYFIELD_CHECK(
        formats::write_text_file(arguments.report, slam::report_json(drive.report) + "\n", "cannot write report"));
  if (!arguments.picture.empty()) RAYFIELD_CHECK(write_drive_picture(drive, hits, arguments.picture));

  RAYFIELD_CHECK(cloud.close());
  outputs.keep();
  const std::uint64_t rays = cloud.ray_count();

  for (const std::string& warning : drive.rays->warnings()) context.progress.warn(warning);
  if (context.options.json)  // else they stand in the summary
    for (const std::string& warning : drive.report.warnings) context.progress.warn(warning);
  const std::vector<std::string> warnings = all_warnings(drive);
  Outcome outcome;
  outcome.data = {{"log", arguments.log},
                  {"cloud", arguments.cloud},
                  {"rays", rays},
                  {"crs", drive.trajectory->crs},
                  {"georeferenced", !drive.trajectory->crs.empty()},
                  {"warnings", warnings}};
  if (arguments.given.empty()) outcome.data["report"] = nlohmann::ordered_json::parse(slam::report_json(drive.report));
  outcome.text = (arguments.given.empty() ? slam::report_summary(drive.report) : "") +
                 fmt::format("{}: {} rays\n", arguments.cloud, grouped(rays));
  return outcome;
}

}  // namespace

void add_slam_command(Commands& commands) {
  const auto arguments = std::make_shared<SlamArguments>();
  CLI::App* command =
      commands.add("slam", "Register a log: from lidar, IMU and GPS to a georeferenced ray cloud",
                   "rayfield slam scan.bag --rig rig.toml --crs EPSG:7854 -o scan.ply --report scan.json",
                   [arguments](Context& context) { return run_slam_command(*arguments, context); });
  command->add_option("LOG", arguments->log, "ROS 1 bag")->required();
  command->add_option("--rig", arguments->rig, "Rig file (docs/rig.md)")->required();
  command->add_option("--crs", arguments->crs, "Projected CRS of the ray cloud (default: a local frame)");
  command->add_option("-o,--output", arguments->cloud, "Ray cloud to write (raycloudtools PLY)")->required();
  command->add_option("--trajectory", arguments->trajectory, "Write the trajectory (TUM text)");
  command->add_option("--report", arguments->report, "Write the quality report (JSON)");
  command->add_option("--picture", arguments->picture, "Write a plan view of trajectory, GPS and point density (PNG)");
  command->add_option("--use-trajectory", arguments->given,
                      "Do not estimate: take this trajectory (TUM text of the IMU frame)");
  add_settings_option(*command, arguments->settings);
}

}  // namespace rayfield::cli
