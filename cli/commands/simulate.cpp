#include <fmt/core.h>

#include <memory>
#include <string>
#include <vector>

#include "cli/commands/commands.h"
#include "cli/console/output_paths.h"
#include "cli/console/text.h"
#include "cli/simulation/simulation.h"
#include "cli/simulation/simulation_needs.h"

namespace rayfield::cli {
namespace {

struct SimulateArguments {
  std::string site, folder;
  std::vector<std::string> dates;
  SimulationOutput output;
};

// Leaves the dates that were asked for: by day or by the name of the folder.
Result<void> select_dates(const std::vector<std::string>& wanted, sim::Site& site) {
  if (wanted.empty()) return {};
  std::vector<sim::SiteDate> selected;
  std::vector<bool> met(wanted.size(), false);
  for (const sim::SiteDate& date : site.dates) {
    bool take = false;
    for (std::size_t k = 0; k < wanted.size(); ++k)
      if (wanted[k] == date.date || wanted[k] == scan_folder_name(date)) take = met[k] = true;
    if (take) selected.push_back(date);
  }
  for (std::size_t k = 0; k < wanted.size(); ++k)
    if (!met[k])
      return fail(ErrorCode::usage, "cannot simulate", site.name, fmt::format("it has no date {}", wanted[k]),
                  "leave --date out to simulate them all");
  site.dates = std::move(selected);
  return {};
}

// Nothing is simulated before it is known that every date's folder is free: a simulation takes minutes.
Result<Outcome> run_simulate(SimulateArguments arguments, const Context& context) {
  RAYFIELD_CHECK(check_outside_stores(arguments.folder, "cannot simulate", "give another -o"));
  RAYFIELD_ASSIGN(sim::Site site, sim::read_site(arguments.site));
  RAYFIELD_CHECK(select_dates(arguments.dates, site));
  Outcome outcome;
  outcome.data = {{"site", site.name},
                  {"folder", arguments.folder},
                  {"crs", site.crs_code()},
                  {"dry_run", context.options.dry_run},
                  {"scans", nlohmann::ordered_json::array()}};
  namespace fs = std::filesystem;
  for (const sim::SiteDate& date : site.dates) {
    const fs::path folder = fs::path(arguments.folder) / scan_folder_name(date);
    if (fs::exists(folder) && !context.options.overwrite)
      return fail(ErrorCode::usage, "cannot simulate", folder.string(), "it is there already",
                  "give another -o, or --overwrite");
  }
  if (context.options.dry_run) {
    arguments.output.threads = context.options.threads;
    RAYFIELD_ASSIGN(const SimulationNeeds simulation, simulation_needs(site, arguments.output, context.progress));
    outcome.data["beams"] = simulation.beams;
    outcome.data["duration_s"] = simulation.duration_s;
    outcome.text = fmt::format("Would simulate {} date{} of {} into {}: {:.0f} s of driving, {} beams\n",
                               site.dates.size(), site.dates.size() == 1 ? "" : "s", site.name, arguments.folder,
                               simulation.duration_s, grouped(simulation.beams));
    add_needs(simulation.needs, arguments.folder, outcome);
    return outcome;
  }
  arguments.output.threads = context.options.threads;
  RAYFIELD_ASSIGN(const auto scans, simulate_site(site, arguments.folder, arguments.output, context.progress));
  for (const SimulatedScan& scan : scans) {
    outcome.data["scans"].push_back({{"folder", scan.folder.string()},
                                     {"date", scan.date},
                                     {"name", scan.name},
                                     {"beams", scan.summary.beams},
                                     {"hits", scan.summary.hits},
                                     {"leaf_area_m2", scan.leaf_area_m2}});
    outcome.text += fmt::format("{}: {} beams, {} hits, {:.1f} m² of leaves\n", scan.folder.string(),
                                grouped(scan.summary.beams), grouped(scan.summary.hits), scan.leaf_area_m2);
  }
  return outcome;
}

}  // namespace

void add_simulate_command(Commands& commands) {
  const auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command = commands.add(
      "simulate", "Simulate a vineyard: logs, rig files, ray clouds with true poses, and truth, a folder per date",
      "rayfield simulate site.toml -o logs",
      [arguments](Context& context) { return run_simulate(*arguments, context); });
  command->add_option("SITE.toml", arguments->site, "The vineyard and its scans (docs/simulation.md)")->required();
  command->add_option("-o,--output", arguments->folder, "Folder to write to")->required();
  add_dates_option(*command, arguments->dates, "Only these dates, or scans as date_name (default: all)");
  command->add_flag("!--no-log", arguments->output.log, "Leave out scan.bag and rig.toml");
  command->add_flag("!--no-rays", arguments->output.rays, "Leave out rays.ply");
}

}  // namespace rayfield::cli
