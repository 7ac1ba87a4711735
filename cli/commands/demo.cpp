#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/console/output_paths.h"
#include "cli/console/text.h"
#include "cli/products/export_block.h"
#include "cli/products/report_block.h"
#include "cli/scans/add_scan.h"
#include "cli/simulation/simulation.h"
#include "cli/simulation/truth_comparison.h"
#include "demo_site.h"
#include "rayfield/density/density.h"
#include "rayfield/formats/text_output.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

// Where the demonstration lies.
struct DemoFolders {
  fs::path root, logs, block, maps, report;
  explicit DemoFolders(const std::string& folder)
      : root(folder),
        logs(root / "logs"),
        block(root / "demo_block"),
        maps(root / "maps"),
        report(root / "report.html") {}
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
    for (const fs::path& part : {folders.logs, folders.block, folders.maps, folders.report})
      fs::remove_all(part, failed);
  return {};
}

// The chain of commands that a user would type: every log through SLAM, laid on the first date, mapped.
Result<tile::Store> build_block(const DemoFolders& folders, const std::string& crs,
                                const std::vector<SimulatedScan>& scans, const Context& context) {
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::create(folders.block, {.crs = crs}));
  for (const SimulatedScan& scan : scans) {
    const fs::path log = scan.folder / "scan.bag", rig = scan.folder / "rig.toml";
    tile::AddOptions options;
    options.date = scan.date, options.name = scan.name;
    options.threads = context.options.threads, options.memory_bytes = context.options.memory_bytes;
    options.command = fmt::format("rayfield add {} {} --rig {} --date {}", folders.block.string(), log.string(),
                                  rig.string(), scan.date);
    RAYFIELD_CHECK(add_scan(store, {.files = {log}, .rig_file = rig.string()}, options, context.progress));
  }
  density::ProcessOptions process;
  process.threads = context.options.threads;
  RAYFIELD_CHECK(
      density::process(store, process, fmt::format("rayfield process {}", folders.block.string()), context.progress));
  return store;
}

Result<void> write_report(const tile::Store& store, const fs::path& file, Progress& progress) {
  RAYFIELD_ASSIGN(const formats::BlockReport report, load_report(store, {}, progress));
  RAYFIELD_ASSIGN(const std::string html, formats::report_html(report));
  return formats::write_text_file(file.string(), html, "cannot write report");
}

// What was measured beside what is true, one line per date.
Result<void> report_truth(const tile::Store& store, const std::vector<SimulatedScan>& scans, Outcome& outcome) {
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const BlockProducts block, density::load_block(store, snapshot, {}));
  outcome.data["dates"] = nlohmann::ordered_json::array();
  outcome.text += "Measured from the logs against the simulation's truth:\n";
  for (std::size_t i = 0; i < scans.size() && i < block.scans.size(); ++i) {
    const TruthComparison c = compare_with_truth(block, block.scans[i], scans[i].panels);
    outcome.data["dates"].push_back({{"scan_id", block.scans[i].scan.scan_id},
                                     {"panels", c.panels},
                                     {"plant_area_m2", c.plant_area_m2},
                                     {"true_plant_area_m2", c.true_plant_area_m2},
                                     {"plant_rrmse", c.plant_rrmse},
                                     {"leaf_area_m2", c.leaf_area_m2},
                                     {"true_leaf_area_m2", c.true_leaf_area_m2},
                                     {"leaf_rms_m2", c.leaf_rms_m2}});
    outcome.text += fmt::format(
        "  {}  plant area {:6.1f} m² (true {:6.1f}, panels to {:4.1f} %)   leaf area {:6.1f} m² (true {:6.1f}, panels "
        "to {:.2f} m²)\n",
        scans[i].date, c.plant_area_m2, c.true_plant_area_m2, 100 * c.plant_rrmse, c.leaf_area_m2, c.true_leaf_area_m2,
        c.leaf_rms_m2);
  }
  return {};
}

// Simulates the small vineyard at all its dates, maps it, and holds the areas against the truth.
Result<Outcome> run_demo(const std::string& folder, const Context& context) {
  const DemoFolders folders(folder);
  RAYFIELD_CHECK(check_outside_stores(folders.root, "cannot run the demonstration", "give another DIR"));
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
                  simulate_site(site, folders.logs, {.log = true, .rays = false, .threads = context.options.threads},
                                context.progress));
  RAYFIELD_ASSIGN(const tile::Store store, build_block(folders, site.crs_code(), scans, context));
  RAYFIELD_ASSIGN(const ExportReport exported, export_block(store, folders.maps, {}, context.progress));

  RAYFIELD_CHECK(write_report(store, folders.report, context.progress));

  const std::string logs = folders.logs.string(), block = folders.block.string(), maps = folders.maps.string();
  outcome.data = {{"folder", folder},
                  {"logs", logs},
                  {"store", block},
                  {"maps", maps},
                  {"report", folders.report.string()},
                  {"files", nlohmann::ordered_json::array()}};
  for (const fs::path& path : exported.products) outcome.data["files"].push_back(path.string());
  outcome.text = fmt::format(
      "\nThe demonstration block is mapped: three drives, each from its raw log through SLAM, laid on the first.\n"
      "  logs and truth   {}\n"
      "  tile store       {}\n"
      "  maps             {}\n\n",
      logs, block, maps);
  RAYFIELD_CHECK(report_truth(store, scans, outcome));
  outcome.text += fmt::format(
      "\nOpen in QGIS: {}/demo_block.gpkg (the project in it)\n"
      "         and: {}/demo_block_{}_plan_density.tif\n"
      "Look at:      {}/demo_block_{}_plan_density.png\n"
      "In a browser: {}\n",
      maps, maps, scans.back().date, maps, scans.back().date, folders.report.string());
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
