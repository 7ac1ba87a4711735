#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/console/alignment_text.h"
#include "cli/console/option_settings.h"
#include "cli/console/text.h"
#include "cli/scans/add_scan.h"
#include "cli/scans/scan_needs.h"
#include "rayfield/core/date.h"

namespace rayfield::cli {
namespace {

struct AddArguments {
  std::string store, date, name, dormant;
  std::vector<std::string> files, settings;
  ScanInputs inputs;
};

// What --dry-run says: whether the scan is there already, and if not how much there is to read and what it takes.
Result<Outcome> describe_add(const tile::Store& store, const ScanInputs& inputs, tile::AddOptions options,
                             Progress& progress) {
  RAYFIELD_ASSIGN(options.inputs, describe_inputs(inputs, options.threads, progress));
  RAYFIELD_ASSIGN(const auto there, store.find_added(options));
  Outcome outcome;
  outcome.data = {{"store", store.folder().string()}, {"dry_run", true}, {"already_there", there.has_value()}};
  if (there) {
    outcome.data["scan_id"] = there->scan_id;
    outcome.text = fmt::format("{}: already in the store, with the same content; nothing to do\n", there->scan_id);
    return outcome;
  }
  RAYFIELD_ASSIGN(const tile::Snapshot latest, store.latest());
  RAYFIELD_ASSIGN(const ScanNeeds scan, scan_needs(inputs, store.config().crs, latest, options.memory_bytes, progress));
  outcome.data["rays"] = scan.rays;
  outcome.text =
      fmt::format("Would {}add up to {} rays\n", scan.logs > 0 ? "register the log and " : "", grouped(scan.rays));
  add_needs(scan.needs, store.folder(), outcome);
  return outcome;
}

// Adds the scan, then says what became of it: warnings that were shown while the inputs were read are not said twice.
Result<Outcome> run_add(const AddArguments& arguments, const Context& context) {
  tile::AddOptions options;
  RAYFIELD_ASSIGN(options.date, parse_date(arguments.date));
  options.name = arguments.name;
  if (!arguments.dormant.empty()) options.dormant = arguments.dormant == "yes";
  options.overwrite = context.options.overwrite;
  options.threads = context.options.threads;
  options.memory_bytes = context.options.memory_bytes;
  options.command = context.command_line;
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::open(arguments.store));
  ScanInputs inputs = arguments.inputs;
  inputs.files.assign(arguments.files.begin(), arguments.files.end());
  RAYFIELD_CHECK(apply_settings(arguments.settings, inputs.align_options));
  RAYFIELD_CHECK(inputs.align_options.validate());
  if (context.options.dry_run) return describe_add(store, inputs, options, context.progress);
  RAYFIELD_ASSIGN(const AddedScan added, add_scan(store, inputs, options, context.progress));
  const tile::AddReport& report = added.report;

  Outcome outcome;
  outcome.data = {
      {"store", arguments.store},
      {"scan_id", report.scan_id},
      {"already_there", report.already_there},
      {"rays", report.ray_count},
      {"hits", report.hit_count},
      {"segments", report.segment_count},
      {"tiles", report.tile_count},
      {"bytes_written", report.bytes_written},
      {"bytes_per_ray",
       report.ray_count > 0 ? static_cast<double>(report.bytes_written) / static_cast<double>(report.ray_count) : 0.0},
      {"dropped", report.dropped},
      {"warnings", report.warnings},
      {"notes", added.notes}};
  if (report.already_there) {
    outcome.text = fmt::format(
        "{}: already in the store, with the same content; nothing to do{}\n", report.scan_id,
        options.dormant ? " but to take it as " + std::string(*options.dormant ? "" : "not ") + "dormant from now on"
                        : "");
    return outcome;
  }
  outcome.text = fmt::format("{}: {} rays in {} tiles, {}\n", report.scan_id, grouped(report.ray_count),
                             report.tile_count, bytes_text(report.bytes_written));
  if (added.alignment) {
    outcome.data["alignment"] = alignment_json(*added.alignment);
    outcome.text += fmt::format("  {}\n", alignment_text(*added.alignment));
  }
  if (context.options.verbose > 0)
    for (const std::string& note : added.notes) outcome.text += fmt::format("  {}\n", note);
  for (const std::string& warning : report.warnings)
    if (std::find(added.shown_warnings.begin(), added.shown_warnings.end(), warning) == added.shown_warnings.end())
      context.progress.warn(warning);
  return outcome;
}

}  // namespace

// `rayfield add`: its arguments, options and help.
void add_add_command(Commands& commands) {
  const auto arguments = std::make_shared<AddArguments>();
  CLI::App* command =
      commands.add("add", "Tile a scan into the store", "rayfield add myblock scan.ply --date 2019-02-11",
                   [arguments](Context& context) { return run_add(*arguments, context); });
  command->add_option("STORE", arguments->store, "Folder of the store")->required();
  command
      ->add_option(
          "LOG|CLOUD", arguments->files,
          "Ray clouds (raycloudtools PLY, LAS with --trajectory) or logs (ROS 1 bag) of one scan, in the order "
          "of their times")
      ->required();
  command->add_option("--date", arguments->date, "Day of the scan, YYYY-MM-DD")->required();
  command->add_option(
      "--rig", arguments->inputs.rig_file,
      "Rig file: of a log all of it, of a ray cloud the lidar's beam, of LAS also where the lidar stands "
      "in the trajectory's frame (docs/rig.md)");
  command->add_option("--trajectory", arguments->inputs.trajectory_file,
                      "Path of the drive of LAS clouds: TUM text, or a table with the columns time, x, y, z "
                      "(docs/ray-cloud-las.md)");
  command->add_option("--name", arguments->name,
                      "Label of the scan, e.g. veraison; needed for a second scan of one day");
  command
      ->add_option(
          "--dormant", arguments->dormant,
          "yes: the vines bear no leaves, and what is seen is the wood that leaf areas of other dates are freed "
          "of; no: they do (default: decided by date and plant area; of a scan that is there it is changed)")
      ->transform(CLI::IsMember({"yes", "no"}, CLI::ignore_case));
  command->add_flag(
      "--restore-missing,!--no-restore-missing", arguments->inputs.restore_missing,
      "Put back the downward rays without a return that clouds leave out, from the beams' timing (docs/density.md; "
      "the default)");
  command->add_flag("--align,!--no-align", arguments->inputs.align,
                    "Lay the scan on the block's reference by posts, trunks and ground (docs/seasons.md; the default)");
  command->add_flag("--allow-truncated", arguments->inputs.allow_truncated,
                    "Take what is there of a cloud that was cut short");
  add_settings_option(*command, arguments->settings);
}

}  // namespace rayfield::cli
