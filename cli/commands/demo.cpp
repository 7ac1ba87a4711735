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

// Where the demonstration lies.
struct DemoFolders {
  fs::path root, logs, block, maps;
  explicit DemoFolders(const std::string& folder)
      : root(folder), logs(root / "logs"), block(root / "demo_block"), maps(root / "maps") {}
};

// A folder that holds something is taken only where that is an earlier demonstration and may be replaced.
Result<void> clear_folders(const DemoFolders& folders, const CommonOptions& options) {
  std::error_code failed;
  if (!fs::exists(folders.root) || fs::is_empty(folders.root, failed)) return {};
  const bool ours = fs::exists(folders.block / "store.json") || fs::exists(folders.logs);
  if (!options.overwrite || !ours)
    return fail(ErrorCode::usage, "cannot run the demonstration", folders.root.string(),
                ours ? "it is there already" : "the folder is not empty",
                ours ? "give another DIR, or --overwrite" : "give another DIR");
  if (!options.dry_run)
    for (const fs::path& part : {folders.logs, folders.block, folders.maps}) fs::remove_all(part, failed);
  return {};
}

// The chain of commands that a user would type, on clouds with true poses.
Result<std::vector<fs::path>> map_scans(const DemoFolders& folders, const std::string& crs,
                                        const std::vector<SimulatedScan>& scans, const Context& context) {
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::create(folders.block, {.crs = crs}));
  for (const SimulatedScan& scan : scans) {
    tile::AddOptions options;
    options.date = scan.date, options.name = scan.name;
    options.threads = context.options.threads, options.memory_bytes = context.options.memory_bytes;
    options.command = fmt::format("rayfield add {} {} --date {}", folders.block.string(),
                                  (scan.folder / "rays.ply").string(), scan.date);
    RAYFIELD_CHECK(add_scan(store, {.files = {scan.folder / "rays.ply"}}, options, context.progress));
  }
  density::ProcessOptions process;
  process.threads = context.options.threads;
  RAYFIELD_CHECK(
      density::process(store, process, fmt::format("rayfield process {}", folders.block.string()), context.progress));
  return export_block(store, folders.maps, {}, context.progress);
}

Result<Outcome> run_demo(const std::string& folder, const Context& context) {
  const DemoFolders folders(folder);
  RAYFIELD_CHECK(clear_folders(folders, context.options));
  RAYFIELD_ASSIGN(const sim::Site site, sim::parse_site(kDemoSite, "demo.toml"));
  Outcome outcome;
  if (context.options.dry_run) {
    outcome.data = {{"folder", folder}, {"dry_run", true}, {"dates", site.dates.size()}};
    outcome.text =
        fmt::format("Would simulate {} dates of a vineyard into {} and map them\n", site.dates.size(), folder);
    return outcome;
  }
  RAYFIELD_ASSIGN(const auto scans,
                  simulate_site(site, folders.logs, {.log = true, .rays = true, .threads = context.options.threads},
                                context.progress));
  RAYFIELD_ASSIGN(const auto written, map_scans(folders, site.crs_code(), scans, context));

  const std::string logs = folders.logs.string(), block = folders.block.string(), maps = folders.maps.string();
  outcome.data = {
      {"folder", folder}, {"logs", logs}, {"store", block}, {"maps", maps}, {"files", nlohmann::ordered_json::array()}};
  for (const fs::path& path : written) outcome.data["files"].push_back(path.string());
  outcome.text = fmt::format(
      "\nThe demonstration block is mapped.\n"
      "  logs and truth   {}\n"
      "  tile store       {}\n"
      "  maps             {}\n\n"
      "Open in QGIS: {}/demo_block.gpkg (layer panel_by_date comes coloured)\n"
      "         and: {}/demo_block_{}_plan_density.tif\n"
      "Look at:      {}/demo_block_{}_plan_density.png\n",
      logs, block, maps, maps, maps, scans.back().date, maps, scans.back().date);
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
