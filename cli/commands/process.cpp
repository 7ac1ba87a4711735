#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/console/needs.h"
#include "cli/console/option_settings.h"
#include "cli/console/text.h"
#include "rayfield/density/density.h"
#include "rayfield/density/plan.h"

namespace rayfield::cli {
namespace {

struct ProcessArguments {
  std::string store;
  std::vector<std::string> dates, settings;
  // What the command line gives by flags of their own; it wins over `settings`.
  std::optional<double> voxel_m, leaf_size_m2, ellipsoid_ratio, sure_return_m, panel_length_m, raster_cell_m;
  std::optional<std::string> estimator, leaf_angles;
};

Result<density::ProcessOptions> options_of(const ProcessArguments& arguments, const Context& context) {
  density::ProcessOptions options;
  RAYFIELD_CHECK(apply_settings(arguments.settings, options));
  if (arguments.voxel_m) {
    options.segments = density::with_voxel_size(options.segments, *arguments.voxel_m);
    options.voxel_fit.enabled = false;
  }
  if (arguments.panel_length_m) options.posts.panel_length_m = arguments.panel_length_m;
  if (arguments.leaf_size_m2) options.estimator.leaf_size_m2 = *arguments.leaf_size_m2;
  if (arguments.ellipsoid_ratio) options.voxels.leaf_angles.ellipsoid_ratio = *arguments.ellipsoid_ratio;
  if (arguments.sure_return_m) options.voxels.sure_return_m = *arguments.sure_return_m;
  if (arguments.raster_cell_m) options.plan.cell_m = *arguments.raster_cell_m;
  if (arguments.estimator) {
    RAYFIELD_ASSIGN(options.estimator.estimator, density::parse_estimator(*arguments.estimator));
  }
  if (arguments.leaf_angles) {
    RAYFIELD_ASSIGN(options.voxels.leaf_angles.type, density::parse_leaf_angle_type(*arguments.leaf_angles));
  }
  options.dates = arguments.dates;
  options.threads = context.options.threads;
  options.memory_bytes = context.options.memory_bytes;
  options.redo = context.options.overwrite;
  return options;
}

nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

// "plant area 27.3 m²"; undefined values are never printed as numbers.
std::string plant_area_text(const density::ScanReport& scan) {
  const double percent = 100 * scan.observed_fraction;
  if (!std::isfinite(scan.plant_area_m2))
    return fmt::format("plant area undefined: two rays crossed {:.0f} % of the voxels in its {} panels", percent,
                       scan.panels);
  std::string text = fmt::format("plant area {:.1f} m²", scan.plant_area_m2);
  if (scan.panels_with_value < scan.panels)
    text += fmt::format(" in {} of {} panels, undefined in the others ({:.0f} % observed)", scan.panels_with_value,
                        scan.panels, percent);
  return text;
}

// "2018-08-06, 2018-11-22 as they were"
std::string unchanged_text(const std::vector<std::string>& scans) {
  return fmt::format("{} as {} {}", fmt::join(scans, ", "), scans.size() == 1 ? "it" : "they",
                     scans.size() == 1 ? "was" : "were");
}

nlohmann::ordered_json failures_json(const density::ProcessReport& report) {
  auto list = nlohmann::ordered_json::array();
  for (const density::FailedScan& failed : report.failed)
    list.push_back(
        {{"scan_id", failed.scan_id}, {"code", static_cast<int>(failed.error.code)}, {"error", failed.error.line()}});
  return list;
}

// What --dry-run says: the scans, which of them are to be made, and what they take.
Result<Outcome> describe_process(const tile::Store& store, const density::ProcessOptions& options) {
  RAYFIELD_ASSIGN(const density::ProcessPlan plan, density::plan_process(store, options));
  std::vector<std::string> scans, needed;
  for (const density::ScanPlan& scan : plan.scans) {
    scans.push_back(scan.scan_id);
    if (scan.is_needed) needed.push_back(scan.scan_id);
  }
  Outcome outcome;
  outcome.data = {{"store", store.folder().string()}, {"dry_run", true}, {"scans", scans}, {"to_process", needed}};
  if (needed.empty()) {
    outcome.text = fmt::format("Nothing to process: {}\n", unchanged_text(scans));
    return outcome;
  }
  outcome.text = fmt::format("Would process {}{}\n", fmt::join(needed, ", "),
                             plan.layout_is_new ? ", and look for rows and panels" : "");
  add_needs({plan.disk_bytes(), 0, options.memory_bytes}, store.folder(), outcome);
  return outcome;
}

nlohmann::ordered_json scan_json(const density::ScanReport& scan) {
  nlohmann::ordered_json json = {{"scan_id", scan.scan_id},
                                 {"rays", scan.rays},
                                 {"plant_area_m2", number_or_null(scan.plant_area_m2)},
                                 {"panels", scan.panels},
                                 {"panels_with_value", scan.panels_with_value},
                                 {"observed_fraction", scan.observed_fraction},
                                 {"leaf_area_m2", nullptr},
                                 {"wood_scan_id", nullptr},
                                 {"wood_from", nullptr},
                                 {"leaf_area_low_m2", nullptr},
                                 {"leaf_area_high_m2", nullptr},
                                 {"leaf_size_cm2", 1e4 * scan.leaf_size_m2},
                                 {"voxel_m", scan.voxel_m},
                                 {"files_made", scan.files_made},
                                 {"files_kept", scan.files_kept},
                                 {"notes", scan.notes}};
  if (!scan.leaf_area_m2) return json;
  json["leaf_area_m2"] = *scan.leaf_area_m2, json["wood_from"] = scan.wood_from;
  json["leaf_area_low_m2"] = scan.leaf_low_m2, json["leaf_area_high_m2"] = scan.leaf_high_m2;
  if (!scan.wood_scan_id.empty()) json["wood_scan_id"] = scan.wood_scan_id;
  return json;
}

// ", leaf area 21.4 m² (less the wood of 2019-08-01)"
std::string leaf_area_text(const density::ScanReport& scan) {
  if (!scan.leaf_area_m2) return "";
  const std::string area = fmt::format(", leaf area {:.1f} m²", *scan.leaf_area_m2);
  if (scan.wood_scan_id.empty())
    return fmt::format("{} ({:.1f} to {:.1f}: wood estimated)", area, scan.leaf_low_m2, scan.leaf_high_m2);
  return area + (scan.wood_scan_id == scan.scan_id ? " (dormant)" : " (less the wood of " + scan.wood_scan_id + ")");
}

// A line with the scan's areas, and its notes below.
std::string scan_text(const density::ScanReport& scan) {
  const std::string leaf_area = leaf_area_text(scan);
  std::string text =
      fmt::format("  {}  {}{}, leaves of {:.0f} cm², voxels of {:.0f} cm{}\n", scan.scan_id, plant_area_text(scan),
                  leaf_area, 1e4 * scan.leaf_size_m2, 100 * scan.voxel_m, scan.files_made == 0 ? " (unchanged)" : "");
  for (const std::string& note : scan.notes) text += fmt::format("    note: {}\n", note);
  return text;
}

// What was made of every scan; unchanged scans share a line, except with -v.
std::string scans_text(const density::ProcessReport& report, bool all) {
  std::string text = fmt::format("{} rows, {} panels, {} posts{}\n", report.rows, report.panels, report.posts,
                                 report.layout_is_new ? " (found now, kept from now on)" : "");
  std::vector<std::string> unchanged;
  for (const density::ScanReport& scan : report.scans) {
    if (scan.files_made > 0 || all)
      text += scan_text(scan);
    else
      unchanged.push_back(scan.scan_id);
  }
  if (unchanged.empty()) return text;
  if (unchanged.size() == report.scans.size())
    return fmt::format("Nothing to process: {}\n", unchanged_text(unchanged));
  return text + fmt::format("  {}\n", unchanged_text(unchanged));
}

// Processes the store and reports per scan.
Result<Outcome> run_process(const ProcessArguments& arguments, const Context& context) {
  RAYFIELD_ASSIGN(const density::ProcessOptions options, options_of(arguments, context));
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::open(arguments.store));
  if (context.options.dry_run) return describe_process(store, options);
  RAYFIELD_ASSIGN(const density::ProcessReport report,
                  density::process(store, options, context.command_line, context.progress));
  Outcome outcome;
  outcome.data = {{"store", arguments.store},
                  {"rows", report.rows},
                  {"panels", report.panels},
                  {"posts", report.posts},
                  {"layout_is_new", report.layout_is_new},
                  {"notes", report.notes},
                  {"scans", nlohmann::ordered_json::array()}};
  for (const density::ScanReport& scan : report.scans) outcome.data["scans"].push_back(scan_json(scan));
  outcome.text = scans_text(report, context.options.verbose > 0);
  outcome.data["failed"] = failures_json(report);
  for (const density::FailedScan& failed : report.failed) {
    context.progress.warn(failed.error.line());
    outcome.failures.push_back(failed.error.line());
    outcome.text += fmt::format("  {}  failed: {}\n", failed.scan_id, failed.error.line());
    outcome.data["exit_code"] = static_cast<int>(report.failed.front().error.code);
  }
  outcome.data["outdated_leaf_areas"] = report.outdated_leaf_areas;
  if (!report.outdated_leaf_areas.empty())
    outcome.text += fmt::format(
        "  note: leaf areas of {} were made with the wood of another scan than they would be "
        "now; run `rayfield process` without --date\n",
        fmt::join(report.outdated_leaf_areas, ", "));
  if (context.options.verbose > 0)
    for (const std::string& note : report.notes) outcome.text += fmt::format("  note: {}\n", note);
  return outcome;
}

}  // namespace

// `rayfield process`: its arguments, options and help. Flags are short names for options of docs/options.md.
void add_process_command(Commands& commands) {
  const auto arguments = std::make_shared<ProcessArguments>();
  CLI::App* command =
      commands.add("process", "Ground, rows, panels, voxels and density; only what changed", "rayfield process myblock",
                   [arguments](Context& context) { return run_process(*arguments, context); });
  command->add_option("STORE", arguments->store, "Folder of the store")->required();
  add_dates_option(*command, arguments->dates, "Only these dates or scans (default: all)");
  const auto valid = valid_for<density::ProcessOptions>;
  command
      ->add_option("--voxel-size", arguments->voxel_m,
                   "Side of a voxel, m (default: fitted to the leaves, 0.06 to 0.12)")
      ->check(valid("segments.voxel_m"));
  command->add_option("--estimator", arguments->estimator, "unbiased (the default), or paper (the published method)")
      ->check(valid("estimator.estimator"));
  command
      ->add_option("--leaf-area", arguments->leaf_size_m2,
                   "Area of one leaf, m²; 0: infinitesimal leaves; below 0: measured from the scan (the default)")
      ->check(valid("estimator.leaf_size_m2"));
  command
      ->add_option("--leaf-angles", arguments->leaf_angles,
                   "Leaf angle distribution: measured from each scan (the default), spherical, uniform, planophile, "
                   "erectophile, plagiophile, extremophile, ellipsoidal")
      ->check(valid("voxels.leaf_angles.type"));
  command
      ->add_option("--ellipsoid-ratio", arguments->ellipsoid_ratio,
                   "Of ellipsoidal leaf angles: horizontal over vertical semi-axis (default: 1)")
      ->check(valid("voxels.leaf_angles.ellipsoid_ratio"));
  command
      ->add_option("--sure-return", arguments->sure_return_m,
                   "Leave out rays that go down and would not meet the ground within this distance, m: clouds lack "
                   "those that came back from nowhere; 0: count all, as is done where a scan holds them")
      ->check(valid("voxels.sure_return_m"));
  command
      ->add_option("--panel-length", arguments->panel_length_m,
                   "Length of a panel, m (default: between the posts found)")
      ->check(valid("posts.panel_length_m"));
  command
      ->add_option("--raster-cell", arguments->raster_cell_m,
                   fmt::format("Cell of the maps, m (default: {})", density::PlanRasterOptions().cell_m))
      ->check(valid("plan.cell_m"));
  add_settings_option(*command, arguments->settings);
}

}  // namespace rayfield::cli
