#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "cli/blocks/block_list.h"
#include "cli/blocks/update_block.h"
#include "cli/blocks/update_needs.h"
#include "cli/commands/commands.h"
#include "cli/console/option_settings.h"
#include "cli/console/text.h"
#include "rayfield/core/date.h"
#include "rayfield/core/text_file.h"

namespace rayfield::cli {
namespace {

using nlohmann::ordered_json;

struct UpdateArguments {
  std::string store, list, output;
  std::vector<std::string> files;
  BlockUpdate block;
};

UpdateOptions options_of(const Context& context) {
  return {context.options.overwrite, context.options.threads, context.options.memory_bytes, context.command_line};
}

std::size_t files_made(const density::ProcessReport& report) {
  std::size_t made = 0;
  for (const density::ScanReport& scan : report.scans) made += scan.files_made;
  return made;
}

ordered_json to_json(const BlockUpdate& block, const UpdateReport& report) {
  ordered_json json = {{"store", block.store.string()},
                       {"scan_id", report.added.report.scan_id},
                       {"already_there", report.added.report.already_there},
                       {"rays", report.added.report.ray_count},
                       {"warnings", report.added.report.warnings},
                       {"notes", report.added.notes},
                       {"panels", report.processed.panels},
                       {"files_made", files_made(report.processed)},
                       {"snapshot", report.snapshot}};
  if (!report.processed.failed.empty()) {
    json["failed"] = ordered_json::array();
    for (const density::FailedScan& scan : report.processed.failed)
      json["failed"].push_back({{"scan_id", scan.scan_id}, {"error", scan.error.line()}});
  }
  if (!report.exported) return json;
  json["products_written"] = report.exported->written;
  json["products"] = ordered_json::array();
  for (const auto& path : report.exported->products) json["products"].push_back(path.string());
  return json;
}

// "2019-02-11: 3 200 000 rays added; 120 files made; 9 of 30 products written"
std::string to_text(const UpdateReport& report) {
  const tile::AddReport& scan = report.added.report;
  std::string text = fmt::format("{}: {}", scan.scan_id,
                                 scan.already_there ? "there already" : grouped(scan.ray_count) + " rays added");
  const std::size_t made = files_made(report.processed);
  text += made == 0 ? "; nothing to process" : fmt::format("; {} files made", made);
  for (const density::FailedScan& failed : report.processed.failed) text += "; " + failed.scan_id + " failed";
  if (report.exported)
    text += report.exported->written == 0 ? "; products as they were"
                                          : fmt::format("; {} products written", report.exported->written);
  return text;
}

// The code of the first scan that could not be processed.
std::optional<ErrorCode> failure_of(const UpdateReport& report) {
  if (report.processed.failed.empty()) return std::nullopt;
  return report.processed.failed.front().error.code;
}

// Warnings of the scan that were not shown while it was read.
void show_warnings(const UpdateReport& report, Progress& progress) {
  for (const density::FailedScan& scan : report.processed.failed) progress.warn(scan.error.line());
  if (report.added.report.already_there) return;
  const std::vector<std::string>& shown = report.added.shown_warnings;
  for (const std::string& warning : report.added.report.warnings)
    if (std::find(shown.begin(), shown.end(), warning) == shown.end()) progress.warn(warning);
}

// "Would make myblock, add up to 2 900 000 rays, process 2018-08-06 and export to maps"
std::string described(const BlockUpdate& block, const UpdateNeeds& update) {
  if (update.already_there && update.scans.empty()) return block.date + ": there already; nothing to process";
  std::string text = update.makes_store ? fmt::format("Would make {}, ", block.store.string()) : "Would ";
  text += update.already_there ? "process " : fmt::format("add up to {} rays, process them", grouped(update.rays));
  if (!update.already_there && !update.scans.empty()) text += ", and ";
  text += fmt::format("{}", fmt::join(update.scans, ", "));
  return block.output ? text + " and export to " + block.output->string() : text;
}

// What --dry-run says: whether the scan is there, what would be processed, and what all of it takes.
Result<Outcome> describe(const BlockUpdate& block, const Context& context) {
  RAYFIELD_ASSIGN(const UpdateNeeds update, update_needs(block, options_of(context), context.progress));
  Outcome outcome;
  outcome.data = {{"store", block.store.string()},         {"date", block.date},  {"dry_run", true},
                  {"already_there", update.already_there}, {"rays", update.rays}, {"to_process", update.scans}};
  outcome.text = described(block, update) + "\n";
  add_needs(update.needs, block.store, outcome);
  return outcome;
}

Result<Outcome> run_single(const UpdateArguments& arguments, const Context& context) {
  BlockUpdate block = arguments.block;
  block.store = arguments.store;
  block.inputs.files.assign(arguments.files.begin(), arguments.files.end());
  if (!arguments.output.empty()) block.output = arguments.output;
  if (block.store.empty() || block.inputs.files.empty() || block.date.empty())
    return fail(ErrorCode::usage, "wrong usage", "rayfield update", "it needs STORE, LOG|CLOUD and --date, or --batch",
                "see `rayfield update --help`");
  RAYFIELD_CHECK(parse_date(block.date));
  if (context.options.dry_run) return describe(block, context);
  RAYFIELD_ASSIGN(const UpdateReport report, update_block(block, options_of(context), context.progress));
  show_warnings(report, context.progress);
  Outcome outcome{to_json(block, report), to_text(report) + "\n"};
  if (context.options.verbose > 0)
    for (const std::string& note : report.added.notes) outcome.text += fmt::format("  {}\n", note);
  for (const density::FailedScan& failed : report.processed.failed) outcome.failures.push_back(failed.error.line());
  if (const auto failed = failure_of(report)) outcome.data["exit_code"] = static_cast<int>(*failed);
  return outcome;
}

// One line of the table that a batch ends with.
struct BatchRow {
  std::string block, state, what;
};

std::string table_of(const std::vector<BatchRow>& rows) {
  std::size_t block = 0, state = 0;
  for (const BatchRow& row : rows) block = std::max(block, row.block.size()), state = std::max(state, row.state.size());
  std::string text;
  for (const BatchRow& row : rows)
    text += fmt::format("{:<{}}  {:<{}}  {}\n", row.block, block, row.state, state, row.what);
  return text;
}

ordered_json failure_json(const BlockUpdate& block, const Error& error) {
  return {{"store", block.store.string()},
          {"error",
           {{"code", static_cast<int>(error.code)},
            {"what", error.what},
            {"where", error.where},
            {"why", error.why},
            {"next", error.next}}}};
}

// Block after block; a failure is reported and the next one begins. Only Ctrl-C ends it before the last.
Result<Outcome> run_batch(const std::string& list, const Context& context) {
  RAYFIELD_ASSIGN(const std::string text, read_text_file(list, "cannot read list of blocks"));
  RAYFIELD_ASSIGN(const std::vector<BlockUpdate> blocks, parse_block_list(text, list));
  Outcome outcome;
  outcome.data = {{"batch", list}, {"blocks", ordered_json::array()}};
  std::vector<BatchRow> rows;
  std::optional<ErrorCode> failed;
  for (const BlockUpdate& block : blocks) {
    const std::string name = block.store.filename().empty() ? block.store.string() : block.store.filename().string();
    if (failed == ErrorCode::interrupted) {
      outcome.data["blocks"].push_back({{"store", block.store.string()}, {"not_begun", true}});
      rows.push_back({name, "not begun", ""});
      continue;
    }
    if (context.options.dry_run) {
      const auto plan = describe(block, context);
      if (!plan && (!failed || plan.error().code == ErrorCode::interrupted)) failed = plan.error().code;
      outcome.data["blocks"].push_back(plan ? plan->data : failure_json(block, plan.error()));
      rows.push_back({name, "dry run", plan ? plan->text.substr(0, plan->text.find('\n')) : plan.error().line()});
      continue;
    }
    const auto report = update_block(block, options_of(context), context.progress);
    if (report) {
      show_warnings(*report, context.progress);
      for (const density::FailedScan& scan : report->processed.failed) outcome.failures.push_back(scan.error.line());
      outcome.data["blocks"].push_back(to_json(block, *report));
      rows.push_back({name, "done", to_text(*report)});
      if (!failed) failed = failure_of(*report);
      continue;
    }
    const Error& error = report.error();
    if (!failed || error.code == ErrorCode::interrupted) failed = error.code;
    context.progress.warn(error.line());
    outcome.failures.push_back(error.line());
    outcome.data["blocks"].push_back(failure_json(block, error));
    rows.push_back({name, "failed", error.line()});
  }
  outcome.text = table_of(rows);
  if (failed) outcome.data["exit_code"] = static_cast<int>(*failed);
  return outcome;
}

Result<Outcome> run_update(const UpdateArguments& arguments, const Context& context) {
  if (arguments.list.empty()) return run_single(arguments, context);
  const BlockUpdate& block = arguments.block;
  if (!arguments.store.empty() || !arguments.files.empty() || !arguments.output.empty() || !block.date.empty() ||
      !block.name.empty() || !block.crs.empty() || !block.inputs.rig_file.empty() ||
      !block.inputs.trajectory_file.empty() || !block.settings.empty())
    return fail(ErrorCode::usage, "wrong usage", "rayfield update", "--batch takes everything from its list",
                "write it there, see docs/commands.md");
  return run_batch(arguments.list, context);
}

}  // namespace

void add_update_command(Commands& commands) {
  const auto arguments = std::make_shared<UpdateArguments>();
  CLI::App* command = commands.add(
      "update", "Register, add, process and export a scan: the monthly job; or that of many blocks, with --batch",
      "rayfield update myblock scan.bag --rig rig.toml --date 2019-02-11 -o maps",
      [arguments](Context& context) { return run_update(*arguments, context); });
  command->add_option("STORE", arguments->store, "Folder of the store");
  command->add_option("LOG|CLOUD", arguments->files, "Logs or ray clouds of one scan, in the order of their times");
  command->add_option("--date", arguments->block.date, "Day of the scan, YYYY-MM-DD");
  command->add_option(
      "--rig", arguments->block.inputs.rig_file,
      "Rig file: of a log all of it, of a ray cloud the lidar's beam, of LAS also where the lidar stands "
      "in the trajectory's frame (docs/rig.md)");
  command->add_option("--trajectory", arguments->block.inputs.trajectory_file,
                      "Path of the drive of LAS clouds: TUM text, or a table with the columns time, x, y, z "
                      "(docs/ray-cloud-las.md)");
  command->add_option("--name", arguments->block.name, "Label of the scan; needed for a second scan of one day");
  command->add_flag("--align,!--no-align", arguments->block.inputs.align,
                    "Lay the scan on the block's reference by posts, trunks and ground (docs/seasons.md; the default)");
  command->add_option("-o,--output", arguments->output, "Folder to export to: what is missing or changed is written");
  command->add_option("--crs", arguments->block.crs, "Make the store, in this CRS, where there is none");
  command->add_option("--batch", arguments->list, "Update the blocks of a list (docs/commands.md)")
      ->type_name("BLOCKS.toml");
  add_settings_option(*command, arguments->block.settings);
}

}  // namespace rayfield::cli
