#include <fmt/format.h>

#include <cmath>

#include "cli/experiments/experiment_report.h"
#include "cli/experiments/report_text.h"
#include "rayfield/experiments/beam.h"

namespace rayfield::cli {
namespace {

using experiments::BeamCell;
using experiments::BeamExperimentOptions;
using experiments::BeamResult;
using experiments::ThinReference;
using nlohmann::ordered_json;

std::vector<std::string> notes() {
  return {
      "The paper takes beams for lines; nothing of it stands beside this table.",
      "\"Known\": full echo, detection share and leaf size given. \"Measured\": as `process` finds them in the "
      "echoes of one wall; a scan has many more.",
      "Beam: its diameter where it meets the middle of the wall head-on, of which 36 % are at the exit as of a SICK "
      "LMS511.",
      "Thin rays are what a correction can reach at best: the rest of the error is the estimator's, not the beam's."};
}

/// Whether the echoes of some wall sufficed for the correction.
bool told(const BeamCell& cell) { return cell.full_echo.value > 0; }

constexpr std::size_t kColumns = 11;  // of the table of wide beams

double sides(const BeamCell& cell) { return cell.diameter_m / std::sqrt(cell.leaf_size_m2); }

// Options and results in full, for --json.
ordered_json data_of(const BeamExperimentOptions& options, const BeamResult& result) {
  ordered_json data = {{"experiment", "beam"},
                       {"seed", options.seed},
                       {"trials", options.trials},
                       {"exit_share", options.exit_share},
                       {"distance_m", options.distance_m},
                       {"thickness_m", options.thickness_m},
                       {"range_resolution_m", options.range_resolution_m}};
  data["thin"] = ordered_json::array();
  for (const ThinReference& thin : result.thin)
    data["thin"].push_back({{"density_m2_m3", thin.density_m2_m3},
                            {"leaf_area_m2", thin.leaf_size_m2},
                            {"voxel_m", thin.voxel_m},
                            {"known", mean_json(thin.known)},
                            {"measured", mean_json(thin.measured)}});
  data["cells"] = ordered_json::array();
  for (const BeamCell& cell : result.cells)
    data["cells"].push_back({{"density_m2_m3", cell.density_m2_m3},
                             {"leaf_area_m2", cell.leaf_size_m2},
                             {"detection_share", cell.detection_share},
                             {"diameter_m", cell.diameter_m},
                             {"voxel_m", cell.voxel_m},
                             {"counted", mean_json(cell.counted)},
                             {"known", mean_json(cell.known)},
                             {"measured", mean_json(cell.measured)},
                             {"full_echo_ratio", mean_json(cell.full_echo)},
                             {"detection_share_ratio", mean_json(cell.found_share)},
                             {"leaf_area_ratio", mean_json(cell.found_leaf_size)},
                             {"trials_not_told", cell.not_told}});
  data["notes"] = notes();
  return data;
}

std::string text_of(const BeamExperimentOptions& options, const BeamResult& result) {
  TextTable thin({"m²/m³", "leaf, cm²", "voxel, cm", "thin rays, leaf size known", "leaf size measured"});
  for (const ThinReference& t : result.thin)
    thin.add({fmt::format("{:g}", t.density_m2_m3), fmt::format("{:.0f}", 1e4 * t.leaf_size_m2),
              fmt::format("{:.1f}", 100 * t.voxel_m), percent(t.known), percent(t.measured)});
  TextTable table({"m²/m³", "leaf, cm²", "share t", "beam, mm", "beam / leaf", "counted", "corrected, known",
                   "corrected, measured", "full echo found", "t found", "leaf found"});
  for (const BeamCell& cell : result.cells) {
    std::vector<std::string> line = {
        fmt::format("{:g}", cell.density_m2_m3),     fmt::format("{:.0f}", 1e4 * cell.leaf_size_m2),
        fmt::format("{:.2f}", cell.detection_share), fmt::format("{:.0f}", 1000 * cell.diameter_m),
        fmt::format("{:.2f}", sides(cell)),          percent(cell.counted)};
    if (told(cell)) {
      line.insert(line.end(), {percent(cell.known), percent(cell.measured)});
      for (const experiments::Mean* found : {&cell.full_echo, &cell.found_share, &cell.found_leaf_size})
        line.push_back(fmt::format("{:.2f}", found->value));
    }
    line.resize(kColumns, "–");
    table.add(line);
  }
  return fmt::format(
             "Wide beams on a wall of random leaves, {:g} m thick, lidar {:g} m from its middle, range resolution {:g} "
             "m, {} walls per cell, seed {}: error of the leaf area in % ± standard error; what the echoes told as a "
             "ratio to what is true\n\n",
             options.thickness_m, options.distance_m, options.range_resolution_m, options.trials, options.seed) +
         thin.text() + "\n" + table.text() + "\n" + notes_text(notes());
}

formats::ChartPoint point(double x, const experiments::Mean& mean) {
  return {x, 100 * mean.value, 100 * mean.standard_error};
}

/// Leaves of one size and one detection share, by the diameter of the beam.
formats::ChartPanel panel_of(const BeamResult& result, const ThinReference& thin, double share) {
  formats::ChartPanel panel{fmt::format("{:.0f} cm², t = {:.2f}", 1e4 * thin.leaf_size_m2, share), {}};
  formats::ChartSeries counted{"counted", {}, {}}, known{"corrected, known", {}, {}},
      measured{"corrected, measured", {}, {}}, reference{"thin rays", {}, formats::SeriesMark::line};
  for (const BeamCell& cell : result.cells) {
    if (cell.density_m2_m3 != thin.density_m2_m3 || cell.leaf_size_m2 != thin.leaf_size_m2 ||
        cell.detection_share != share)
      continue;
    const double x = 1000 * cell.diameter_m;
    counted.points.push_back(point(x, cell.counted));
    if (!told(cell)) continue;
    known.points.push_back(point(x, cell.known)), measured.points.push_back(point(x, cell.measured));
  }
  for (const double x : {0.0, 50.0}) reference.points.push_back({x, 100 * thin.known.value, 0});
  panel.series = {counted, measured, known, reference};
  return panel;
}

ExperimentChart chart_of(const BeamExperimentOptions& options, const BeamResult& result, double density_m2_m3) {
  ExperimentChart out{fmt::format("beam_{:g}", density_m2_m3),
                      "Wide beams on a wall of random leaves",
                      fmt::format("{:g} m² of leaves per m³, {:g} m thick; t: detection share; {} walls per point",
                                  density_m2_m3, options.thickness_m, options.trials),
                      {}};
  out.chart.x_title = fmt::format("diameter of the beam at {:g} m, mm", options.distance_m);
  out.chart.y_title = "error of the leaf area, %";
  out.chart.x_ticks = {0, 10, 20, 30, 40, 50};
  for (const ThinReference& thin : result.thin)
    for (const double share : options.detection_shares)
      if (thin.density_m2_m3 == density_m2_m3) out.chart.panels.push_back(panel_of(result, thin, share));
  return out;
}

}  // namespace

Result<ExperimentReport> report_beam(const ExperimentRequest& request, Progress& progress) {
  BeamExperimentOptions options;
  options.seed = request.seed, options.threads = request.threads;
  options.trials = request.trials.value_or(options.trials);
  RAYFIELD_ASSIGN(const BeamResult result, run_beam(options, progress));
  ExperimentReport report{data_of(options, result), text_of(options, result), {}};
  for (const double density_m2_m3 : options.densities_m2_m3)
    report.charts.push_back(chart_of(options, result, density_m2_m3));
  return report;
}

}  // namespace rayfield::cli
