#include <fmt/format.h>

#include "cli/experiments/experiment_report.h"
#include "cli/experiments/report_text.h"
#include "rayfield/experiments/spinning.h"

namespace rayfield::cli {
namespace {

using experiments::NormalBody;
using experiments::SpinningCell;
using experiments::SpinningOptions;
using experiments::SpinningResult;
using experiments::SpinningRow;
using nlohmann::ordered_json;

constexpr auto kSphere = static_cast<std::size_t>(NormalBody::sphere),
               kCube = static_cast<std::size_t>(NormalBody::cube);

std::vector<std::string> notes() {
  return {
      "Slip: rays exactly along x see normals 1,10,1 and 1,1,10 alike, so that the two trawling errors must agree; "
      "the paper has −44.6 and −68.5 %.",
      "The paper does not say how normals are drawn from an ellipsoid. Points even in a cube, times the "
      "eccentricity, normalised, give its spinning column; points even on a sphere are listed beside.",
      "σ: the standard error of the difference; the paper has 400 trials.",
      "\"Infinitesimal\": 2·⟨|n·d|⟩ − 1 over normals n and rays d, what leaves without size and endless rays would "
      "read. It is the error of taking the leaves' directions for spherical, and nothing else."};
}

ordered_json cell_json(const SpinningCell& cell) {
  return {{"debiased", mean_json(cell.debiased)},
          {"unbiased", mean_json(cell.unbiased)},
          {"infinitesimal", mean_json(cell.infinitesimal)}};
}

ordered_json data_of(const SpinningOptions& options, const SpinningResult& result) {
  ordered_json data = {
      {"experiment", "spinning"}, {"seed", options.seed}, {"trials", options.trials}, {"rays", options.rays}};
  data["rows"] = ordered_json::array();
  for (const SpinningRow& row : result.rows)
    data["rows"].push_back({{"eccentricity", {row.eccentricity.x(), row.eccentricity.y(), row.eccentricity.z()}},
                            {"trawling",
                             {{"paper", row.paper_trawling},
                              {"cube", cell_json(row.trawling[kCube])},
                              {"sphere", cell_json(row.trawling[kSphere])}}},
                            {"spinning",
                             {{"paper", row.paper_spinning},
                              {"cube", cell_json(row.spinning[kCube])},
                              {"sphere", cell_json(row.spinning[kSphere])}}}});
  data["notes"] = notes();
  return data;
}

std::string eccentricity_text(const SpinningRow& row) {
  return fmt::format("{:g},{:g},{:g}", row.eccentricity.x(), row.eccentricity.y(), row.eccentricity.z());
}

/// "−1.4"
std::string off_text(double paper, const SpinningCell& cell, std::uint64_t trials) {
  return percent(experiments::paper_deviations(paper, cell.debiased, trials) / 100);
}

std::string text_of(const SpinningOptions& options, const SpinningResult& result) {
  TextTable table({"normals x,y,z", "lidar", "paper", "cube", "paper off, σ", "unbiased", "infinitesimal", "sphere",
                   "paper off, σ", "unbiased", "infinitesimal"});
  for (const SpinningRow& row : result.rows) {
    const auto add = [&](const std::string& lidar, double paper, const std::array<SpinningCell, 2>& cells) {
      const SpinningCell &cube = cells[kCube], &sphere = cells[kSphere];
      std::vector<std::string> line = {eccentricity_text(row), lidar, percent(paper)};
      for (const SpinningCell* cell : {&cube, &sphere})
        line.insert(line.end(), {percent(cell->debiased), off_text(paper, *cell, options.trials),
                                 percent(cell->unbiased), percent(cell->infinitesimal)});
      table.add(line);
    };
    add("trawling", row.paper_trawling, row.trawling);
    add("spinning", row.paper_spinning, row.spinning);
  }
  return fmt::format(
             "Trawling and spinning lidar, leaves of {:g} cm in a voxel of {:g} cm, {} rays, {} trials per cell, seed "
             "{}: error of the leaf area in % ± standard error, by how normals are drawn; de-biased unless it says "
             "otherwise; the columns after \"cube\" and \"sphere\" belong to them\n\n",
             100 * options.leaf_side_m, 100 * options.voxel_m, options.rays, options.trials, options.seed) +
         table.text() + "\n" + notes_text(notes());
}

// Error over eccentricity beside the paper's, one panel for trawling and one for spinning.
ExperimentChart chart_of(const SpinningOptions& options, const SpinningResult& result) {
  ExperimentChart out{"spinning",
                      "Trawling and spinning lidar",
                      fmt::format("Leaf normals that prefer an axis; {} rays, {} trials", options.rays, options.trials),
                      {}};
  out.chart.x_title = "eccentricity of the normals (x along the row, z up)";
  out.chart.y_title = "error of the leaf area, %";
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    out.chart.x_ticks.push_back(static_cast<double>(i));
    out.chart.x_labels.push_back(eccentricity_text(result.rows[i]));
  }
  const auto panel_of = [&](const std::string& title, double SpinningRow::*paper,
                            std::array<SpinningCell, 2> SpinningRow::*cells) {
    formats::ChartPanel panel{title, {}};
    formats::ChartSeries figure{"paper", {}, formats::SeriesMark::discs}, cube{"normals from a cube", {}, figure.mark},
        sphere{"normals from a sphere", {}, figure.mark};
    for (std::size_t i = 0; i < result.rows.size(); ++i) {  // beside each other
      const SpinningRow& row = result.rows[i];
      const auto x = static_cast<double>(i);
      figure.points.push_back({x - 0.08, 100 * row.*paper, 0});
      for (const auto& [series, body, shift] : {std::tuple{&cube, kCube, 0.0}, {&sphere, kSphere, 0.08}}) {
        const experiments::Mean& mean = (row.*cells)[body].debiased;
        series->points.push_back({x + shift, 100 * mean.value, 100 * mean.standard_error});
      }
    }
    panel.series = {figure, cube, sphere};
    out.chart.panels.push_back(panel);
  };
  panel_of("trawling: rays along x", &SpinningRow::paper_trawling, &SpinningRow::trawling);
  panel_of("spinning: rays 0 to 70° from x", &SpinningRow::paper_spinning, &SpinningRow::spinning);
  return out;
}

}  // namespace

Result<ExperimentReport> report_spinning(const ExperimentRequest& request, Progress& progress) {
  SpinningOptions options;
  options.seed = request.seed, options.threads = request.threads;
  options.trials = request.trials.value_or(options.trials);
  RAYFIELD_ASSIGN(const SpinningResult result, run_spinning(options, progress));
  return ExperimentReport{data_of(options, result), text_of(options, result), {chart_of(options, result)}};
}

}  // namespace rayfield::cli
