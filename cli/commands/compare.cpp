#include <fmt/core.h>

#include <cmath>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/console/option_settings.h"
#include "cli/console/output_paths.h"
#include "cli/products/compare_scans.h"
#include "cli/products/season_report.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

using nlohmann::ordered_json;

struct CompareArguments {
  std::string store, folder;
  std::vector<std::string> dates, settings;
};

// JSON has no NaN.
ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(); }

ordered_json scan_json(const ScanProduct& scan) {
  return {{"scan_id", scan.scan_id}, {"date", scan.scan_date}, {"name", scan.name}};
}

ordered_json statistics_json(const PairedStatistics& s) {
  return {{"count", s.count},
          {"mean_a", number(s.mean_a)},
          {"mean_b", number(s.mean_b)},
          {"rmse", number(s.rmse)},
          {"rrmse", number(s.rrmse)},
          {"slope", number(s.slope)},
          {"intercept", number(s.intercept)},
          {"orthogonal_slope", number(s.orthogonal_slope)},
          {"orthogonal_intercept", number(s.orthogonal_intercept)},
          {"r_squared", number(s.r_squared)}};
}

ordered_json panel_json(const PanelChange& p) {
  return {{"panel_uid", p.panel_uid},
          {"row_number", p.row_number},
          {"panel_number", p.panel_number},
          {"length_m", p.length_m},
          {"leaf_area_a_m2", number(p.a.leaf_area_m2)},
          {"leaf_area_b_m2", number(p.b.leaf_area_m2)},
          {"leaf_change_m2", number(p.leaf_change_m2)},
          {"leaf_change_percent", number(p.leaf_change_percent)},
          {"se_change_m2", number(p.se_change_m2)},
          {"ci_low_m2", number(p.ci_low_m2)},
          {"ci_high_m2", number(p.ci_high_m2)},
          {"p_value", number(p.p_value)},
          {"significance", verdict_text(p.verdict)},
          {"plant_area_a_m2", number(p.a.plant_area_m2)},
          {"plant_area_b_m2", number(p.b.plant_area_m2)},
          {"plant_change_m2", number(p.plant_change_m2)}};
}

ordered_json comparison_json(const DateComparison& c) {
  ordered_json json = {{"a", scan_json(c.a)},           {"b", scan_json(c.b)}, {"panels_compared", c.compared},
                       {"panels_not_seen", c.not_seen}, {"gains", c.gains},    {"losses", c.losses}};
  const TotalChange& t = c.leaf_total;
  json["leaf_area"] = {{"a_m2", t.area_a_m2},
                       {"b_m2", t.area_b_m2},
                       {"change_m2", t.change_m2},
                       {"se_m2", t.se_m2},
                       {"ci_low_m2", t.ci_low_m2},
                       {"ci_high_m2", t.ci_high_m2},
                       {"significance", verdict_text(t.verdict)}};
  json["panels_leaf_area_per_m"] = statistics_json(c.leaf_per_m);
  json["panels_plant_area_per_m"] = statistics_json(c.plant_per_m);
  json["half_metres_leaf_area_per_m"] = statistics_json(c.half_metre_leaf_per_m);
  json["half_metres_plant_area_per_m"] = statistics_json(c.half_metre_plant_per_m);
  json["panels"] = ordered_json::array();
  for (const PanelChange& panel : c.panels) json["panels"].push_back(panel_json(panel));
  return json;
}

std::string comparison_text(const DateComparison& c) {
  const TotalChange& t = c.leaf_total;
  std::string text = fmt::format("{} → {}: {} panels", c.a.scan_id, c.b.scan_id, c.compared);
  if (c.not_seen > 0) text += fmt::format(" ({} not seen on both dates)", c.not_seen);
  text += fmt::format("\n  leaf area  {:.1f} → {:.1f} m², {:+.1f} m² (95 %: {:+.1f} … {:+.1f})", t.area_a_m2,
                      t.area_b_m2, t.change_m2, t.ci_low_m2, t.ci_high_m2);
  if (t.area_a_m2 > 0) text += fmt::format(", {:+.1f} %", 100 * t.change_m2 / t.area_a_m2);
  text += fmt::format("\n  panels     {} gain, {} loss, {} within their errors\n", c.gains, c.losses,
                      c.compared - c.gains - c.losses);
  const PairedStatistics& s = c.leaf_per_m;
  if (std::isfinite(s.rrmse)) text += fmt::format("  RRMSE {:.1f} %", 100 * s.rrmse);
  if (std::isfinite(s.slope))
    text += fmt::format(", least-squares trend {:.3f} · x {} {:.3f} m²/m, r² {:.3f}", s.slope,
                        s.intercept < 0 ? "−" : "+", std::abs(s.intercept), s.r_squared);
  return text + "\n";
}

Result<Outcome> compare_two(const CompareArguments& arguments, const tile::Store& store, const Context& context) {
  ComparisonRequest request{arguments.dates[0], arguments.dates[1], {}, {}};
  RAYFIELD_CHECK(apply_settings(arguments.settings, request.options));
  if (!arguments.folder.empty() && !context.options.dry_run) request.folder = arguments.folder;
  RAYFIELD_ASSIGN(const ComparisonReport report, compare_scans(store, request, context.progress));
  Outcome outcome;
  outcome.data = comparison_json(report.comparison);
  outcome.text = comparison_text(report.comparison);
  outcome.data["files"] = ordered_json::array();
  for (const auto& path : report.files) {
    outcome.data["files"].push_back(path.string());
    outcome.text += path.string() + "\n";
  }
  return outcome;
}

// A date of the block in the table of the season.
std::string season_line(const SeasonValue& v) {
  if (v.panels_seen == 0) return fmt::format("  {:<12} not seen  0 of {}\n", v.scan_id, v.panels);
  return fmt::format("  {:<12} {:>8.1f} m²  {:.2f} m²/m ({:.2f} … {:.2f})  {} of {}\n", v.scan_id, v.leaf_area_m2,
                     v.leaf_area_per_m, v.ci_low_per_m, v.ci_high_per_m, v.panels_seen, v.panels);
}

// The whole season: a table of the block's dates, and every row's values for --json; with -o also the files.
Result<Outcome> compare_all(const CompareArguments& arguments, const tile::Store& store, const Context& context) {
  std::optional<std::filesystem::path> folder;
  if (!arguments.folder.empty() && !context.options.dry_run) folder = arguments.folder;
  RAYFIELD_ASSIGN(const SeasonReport report, report_season(store, folder, context.progress));
  Outcome outcome;
  outcome.data["season"] = ordered_json::array();
  outcome.text = "  scan          leaf area  per metre of row (95 %)    panels seen\n";
  for (const SeasonValue& v : report.values) {
    outcome.data["season"].push_back({{"row_number", v.row_number == 0 ? ordered_json() : ordered_json(v.row_number)},
                                      {"scan_id", v.scan_id},
                                      {"date", v.scan_date},
                                      {"panels", v.panels},
                                      {"panels_seen", v.panels_seen},
                                      {"length_m", v.length_m},
                                      {"leaf_area_m2", number(v.leaf_area_m2)},
                                      {"leaf_area_per_m", number(v.leaf_area_per_m)},
                                      {"ci_low_per_m", number(v.ci_low_per_m)},
                                      {"ci_high_per_m", number(v.ci_high_per_m)},
                                      {"plant_area_m2", number(v.plant_area_m2)}});
    if (v.row_number == 0) outcome.text += season_line(v);
  }
  outcome.data["files"] = ordered_json::array();
  for (const auto& path : report.files) {
    outcome.data["files"].push_back(path.string());
    outcome.text += path.string() + "\n";
  }
  return outcome;
}

Result<Outcome> run_compare(const CompareArguments& arguments, const Context& context) {
  if (arguments.dates.size() == 1)
    return fail(ErrorCode::usage, "cannot compare dates", arguments.dates[0], "one date alone",
                "give two dates, or none for the whole season");
  if (!arguments.folder.empty())
    RAYFIELD_CHECK(check_outside_stores(arguments.folder, "cannot compare dates", "give another -o"));
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(arguments.store));
  RAYFIELD_ASSIGN(Outcome outcome, arguments.dates.empty() ? compare_all(arguments, store, context)
                                                           : compare_two(arguments, store, context));
  ordered_json data = {{"store", arguments.store},
                       {"block", store.block_name()},
                       {"folder", arguments.folder},
                       {"dry_run", context.options.dry_run}};
  data.update(outcome.data);
  outcome.data = std::move(data);
  return outcome;
}

}  // namespace

void add_compare_command(Commands& commands) {
  const auto arguments = std::make_shared<CompareArguments>();
  CLI::App* command =
      commands.add("compare", "What changed between two dates, or, without dates, through the whole season",
                   "rayfield compare myblock 2018-12-12 2019-02-11 -o changes",
                   [arguments](Context& context) { return run_compare(*arguments, context); });
  command->add_option("STORE", arguments->store, "Folder of the store")->required();
  command->add_option("DATE", arguments->dates, "Two dates or scans: the change from the first to the second")
      ->expected(0, 2);
  command->add_option("-o,--output", arguments->folder,
                      "Folder for charts, maps and layers (default: only say what changed)");
  add_settings_option(*command, arguments->settings);
}

}  // namespace rayfield::cli
