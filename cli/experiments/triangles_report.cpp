#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/experiments/experiment_report.h"
#include "cli/experiments/report_text.h"
#include "rayfield/experiments/triangles.h"

namespace rayfield::cli {
namespace {

using experiments::Mean;
using experiments::TriangleCell;
using experiments::TriangleOptions;
using experiments::TriangleResult;
using nlohmann::ordered_json;

std::vector<std::string> notes() {
  return {
      "Slip: the paper divides the leaf area by √(3/4)·l² for the number of leaves; a triangle has √3/4·l². Its "
      "\"between 3 and 40 leaves in a voxel\" fits the latter.",
      "Slip: the captions write m for the number of entering rays n.",
      "The paper does not say how leaves at the border count, nor how lines are drawn. Here leaves stand around the "
      "voxel too and their area inside it is what is true; lines are uniform in space.",
      "With the paper's 1600 trials its figures have standard errors √(trials/1600) times those here."};
}

/// Largest |error| and mean |error| of an estimator over the surface.
struct Overall {
  double largest = 0, mean = 0;
};
Overall overall(const TriangleResult& result, Mean TriangleCell::*estimator) {
  Overall out;
  for (const TriangleCell& cell : result.surface) {
    const double error = std::abs((cell.*estimator).value);
    out.largest = std::max(out.largest, error);
    out.mean += error / static_cast<double>(result.surface.size());
  }
  return out;
}

ordered_json cells_json(const std::vector<TriangleCell>& cells) {
  ordered_json json = ordered_json::array();
  for (const TriangleCell& cell : cells)
    json.push_back({{"side_m", cell.leaves.side_m},
                    {"area_m2", cell.leaves.area_m2},
                    {"leaves_in_voxel", cell.leaves_in_voxel},
                    {"rays", cell.rays},
                    {"maximum_likelihood", mean_json(cell.maximum_likelihood)},
                    {"debiased", mean_json(cell.debiased)},
                    {"unbiased", mean_json(cell.unbiased)}});
  return json;
}

ordered_json overall_json(const Overall& of) { return {{"largest_error", of.largest}, {"mean_error", of.mean}}; }

ordered_json data_of(const TriangleOptions& options, const TriangleResult& result) {
  return {{"experiment", "triangles"},
          {"seed", options.seed},
          {"trials", options.trials},
          {"voxel_m", options.voxel_m},
          {"few_rays", cells_json(result.few_rays)},
          {"surface", cells_json(result.surface)},
          {"surface_debiased", overall_json(overall(result, &TriangleCell::debiased))},
          {"surface_unbiased", overall_json(overall(result, &TriangleCell::unbiased))},
          {"paper",
           {{"largest_error", experiments::kPaperLargestError},
            {"mean_error_low", experiments::kPaperMeanErrorLow},
            {"mean_error_high", experiments::kPaperMeanErrorHigh}}},
          {"notes", notes()}};
}

std::string configuration_text(const experiments::LeafConfiguration& leaves) {
  return fmt::format("({:g}, {:g})", leaves.side_m, leaves.area_m2);
}

std::string few_rays_text(const TriangleOptions& options, const TriangleResult& result) {
  std::vector<std::string> heads = {"rays n", "paper: 1/(n − 1)"};
  for (const auto& c : options.configurations) heads.push_back(configuration_text(c));
  TextTable table(heads);
  for (int n = 2; n <= options.most_rays; ++n) {
    std::vector<std::string> line = {fmt::format("{}", n), percent(1.0 / (n - 1))};
    for (const TriangleCell& cell : result.few_rays)
      if (cell.rays == n) line.push_back(percent(cell.maximum_likelihood));
    table.add(line);
  }
  return table.text();
}

std::string surface_text(const TriangleOptions& options, const TriangleResult& result, Mean TriangleCell::*estimator) {
  std::vector<std::string> heads = {"A, m²"};
  for (const double side_m : options.sides_m) heads.push_back(fmt::format("l = {:g} cm", 100 * side_m));
  TextTable table(heads);
  for (const double area_m2 : options.areas_m2) {
    std::vector<std::string> line = {fmt::format("{:g}", area_m2)};
    for (const TriangleCell& cell : result.surface)
      if (cell.leaves.area_m2 == area_m2) line.push_back(percent(cell.*estimator));
    table.add(line);
  }
  const Overall of = overall(result, estimator);
  return table.text() + fmt::format(
                            "\nlargest |error| {:.1f} % (paper: no more than {:.0f} %), mean {:.1f} % (paper: "
                            "{:.0f} to {:.0f} %)\n\n",
                            100 * of.largest, 100 * experiments::kPaperLargestError, 100 * of.mean,
                            100 * experiments::kPaperMeanErrorLow, 100 * experiments::kPaperMeanErrorHigh);
}

std::string text_of(const TriangleOptions& options, const TriangleResult& result) {
  return fmt::format(
             "Triangular leaves in a voxel of {:g} cm, {} trials per cell, seed {}: normalised error in % ± standard "
             "error\n\nFew rays, m/Σx without de-biasing (the paper's figure bias_graph (a)), by (side l in m, area A "
             "in m²):\n\n",
             100 * options.voxel_m, options.trials, options.seed) +
         few_rays_text(options, result) +
         fmt::format("\n{} rays, de-biased (figure bias_graph (b)):\n\n", options.surface_rays) +
         surface_text(options, result, &TriangleCell::debiased) +
         fmt::format("{} rays, the unbiased estimator m/Σx − H/(Σx)²:\n\n", options.surface_rays) +
         surface_text(options, result, &TriangleCell::unbiased) + notes_text(notes());
}

formats::ChartPoint point(double x, const Mean& mean) { return {x, 100 * mean.value, 100 * mean.standard_error}; }

ExperimentChart few_rays_chart(const TriangleOptions& options, const TriangleResult& result) {
  ExperimentChart out{"triangles_few_rays",
                      "Triangular leaves in a voxel, few rays",
                      fmt::format("By leaf side l (m) and leaf area A (m²), {} trials per point", options.trials),
                      {}};
  out.chart.x_title = "number of rays n", out.chart.y_title = "normalised error, %";
  out.chart.x_ticks = {2, 4, 6, 8, 10, 12, 14};
  const std::vector<std::pair<std::string, Mean TriangleCell::*>> estimators = {
      {"m/Σx, without de-biasing", &TriangleCell::maximum_likelihood},
      {"de-biased", &TriangleCell::debiased},
      {"unbiased", &TriangleCell::unbiased}};
  for (const auto& [name, estimator] : estimators) {
    formats::ChartPanel panel{name, {}};
    for (const auto& c : options.configurations) {
      formats::ChartSeries series{configuration_text(c), {}, formats::SeriesMark::points};
      for (const TriangleCell& cell : result.few_rays)
        if (cell.leaves.side_m == c.side_m && cell.leaves.area_m2 == c.area_m2)
          series.points.push_back(point(cell.rays, cell.*estimator));
      panel.series.push_back(series);
    }
    out.chart.panels.push_back(panel);
  }
  formats::ChartSeries paper{"paper: 1/(n − 1)", {}, formats::SeriesMark::line};
  for (int n = 2; n <= options.most_rays; ++n) paper.points.push_back({double(n), 100.0 / (n - 1), 0});
  out.chart.panels.front().series.push_back(paper);
  return out;
}

ExperimentChart surface_chart(const TriangleOptions& options, const TriangleResult& result) {
  ExperimentChart out{"triangles_surface",
                      "Triangular leaves in a voxel",
                      fmt::format("{} rays, {} trials per point", options.surface_rays, options.trials),
                      {}};
  out.chart.x_title = "leaf area A in the voxel, cm²", out.chart.y_title = "normalised error, %";
  out.chart.x_ticks = {0, 100, 200, 300};
  const std::vector<std::pair<std::string, Mean TriangleCell::*>> estimators = {{"de-biased", &TriangleCell::debiased},
                                                                                {"unbiased", &TriangleCell::unbiased}};
  for (const auto& [name, estimator] : estimators) {
    formats::ChartPanel panel{name, {}};
    for (const double side_m : options.sides_m) {
      formats::ChartSeries series{fmt::format("l = {:g} cm", 100 * side_m), {}, formats::SeriesMark::points};
      for (const TriangleCell& cell : result.surface)
        if (cell.leaves.side_m == side_m) series.points.push_back(point(1e4 * cell.leaves.area_m2, cell.*estimator));
      panel.series.push_back(series);
    }
    formats::ChartSeries paper{"paper: no more than 8 %", {}, formats::SeriesMark::line};
    for (const double x : {0.0, 300.0}) paper.points.push_back({x, 100 * experiments::kPaperLargestError, 0});
    panel.series.push_back(paper);
    out.chart.panels.push_back(panel);
  }
  return out;
}

}  // namespace

Result<ExperimentReport> report_triangles(const ExperimentRequest& request, Progress& progress) {
  TriangleOptions options;
  options.seed = request.seed, options.threads = request.threads;
  options.trials = request.trials.value_or(options.trials);
  RAYFIELD_ASSIGN(const TriangleResult result, run_triangles(options, progress));
  return ExperimentReport{data_of(options, result),
                          text_of(options, result),
                          {few_rays_chart(options, result), surface_chart(options, result)}};
}

}  // namespace rayfield::cli
