#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/console/text.h"
#include "cli/jobs/add_scan.h"
#include "cli/jobs/export_block.h"
#include "cli/jobs/simulation.h"
#include "demo_site.h"
#include "rayfield/density/density.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

// The chain of commands that a user would type, on a simulated block.
Result<Outcome> run_demo(const std::string& folder, const Context& context) {
  const fs::path root(folder), logs = root / "logs", block = root / "demo_block", maps = root / "maps";
  std::error_code failed;
  if (fs::exists(root) && !fs::is_empty(root, failed)) {
    const bool ours = fs::exists(block / "store.json") || fs::exists(logs);
    if (!context.options.overwrite || !ours)
      return fail(ErrorCode::usage, "cannot run the demonstration", folder,
                  ours ? "it is there already" : "the folder is not empty",
                  ours ? "give another DIR, or --overwrite" : "give another DIR");
    if (!context.options.dry_run)
      for (const fs::path& part : {logs, block, maps}) fs::remove_all(part, failed);
  }
  RAYFIELD_ASSIGN(const sim::Site site, sim::parse_site(kDemoSite, "demo.toml"));
  Outcome outcome;
  if (context.options.dry_run) {
    outcome.data = {{"folder", folder}, {"dry_run", true}, {"dates", site.dates.size()}};
    outcome.text =
        fmt::format("Would simulate {} dates of a vineyard into {} and map them\n", site.dates.size(), folder);
    return outcome;
  }

  RAYFIELD_ASSIGN(
      const auto scans,
      simulate_site(site, logs, {.log = true, .rays = true, .threads = context.options.threads}, context.progress));
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::create(block, {.crs = site.crs_code()}));
  for (const SimulatedScan& scan : scans) {
    tile::AddOptions options;
    options.date = scan.date, options.name = scan.name;
    options.threads = context.options.threads, options.memory_bytes = context.options.memory_bytes;
    options.command =
        fmt::format("rayfield add {} {} --date {}", block.string(), (scan.folder / "rays.ply").string(), scan.date);
    RAYFIELD_CHECK(add_scan(store, {.files = {scan.folder / "rays.ply"}}, options, context.progress));
  }
  density::ProcessOptions process;
  process.threads = context.options.threads;
  RAYFIELD_CHECK(
      density::process(store, process, fmt::format("rayfield process {}", block.string()), context.progress));
  RAYFIELD_ASSIGN(const auto written, export_block(store, maps, {}, context.progress));

  outcome.data = {{"folder", folder},
                  {"logs", logs.string()},
                  {"store", block.string()},
                  {"maps", maps.string()},
                  {"files", nlohmann::ordered_json::array()}};
  for (const fs::path& path : written) outcome.data["files"].push_back(path.string());
  outcome.text = fmt::format(
      "\nThe demonstration block is mapped.\n"
      "  logs and truth   {}\n"
      "  tile store       {}\n"
      "  maps             {}\n\n"
      "Open in QGIS: {} (layer panel_by_date comes coloured)\n"
      "         and: {}\n"
      "Look at:      {}\n",
      logs.string(), block.string(), maps.string(), (maps / "demo_block.gpkg").string(),
      (maps / fmt::format("demo_block_{}_plan_density.tif", scans.back().date)).string(),
      (maps / fmt::format("demo_block_{}_plan_density.png", scans.back().date)).string());
  return outcome;
}

}  // namespace

void add_demo_command(Commands& commands) {
  const auto folder = std::make_shared<std::string>();
  CLI::App* command =
      commands.add("demo", "Simulate a small vineyard at three dates, map it, and say where the maps lie",
                   "rayfield demo out/demo", [folder](Context& context) { return run_demo(*folder, context); });
  command->add_option("DIR", *folder, "Folder to write to")->required();
}

}  // namespace rayfield::cli
