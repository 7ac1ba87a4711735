#include <fmt/format.h>

#include <cmath>

#include "cli/experiments/experiment_report.h"
#include "cli/experiments/report_text.h"
#include "rayfield/experiments/turbid.h"

namespace rayfield::cli {
namespace {

using experiments::kTurbidEstimators;
using experiments::name_of;
using experiments::TurbidCell;
using experiments::TurbidEstimator;
using experiments::TurbidOptions;
using experiments::TurbidResult;
using experiments::UncensoredCell;
using nlohmann::ordered_json;

/// What the paper says, and where it errs. Its figure EstBias stands for no numbers in the text.
std::vector<std::string> notes() {
  return {
      "Paper, figure EstBias: curves without numbers in the text; their caption says \"an underestimation bias\".",
      "Slip: the text calls Mode[λ] = (m − 1)/Σx the maximum likelihood estimate. With the likelihood λ^m·exp(−λΣx) "
      "that is m/Σx, which is too large at any λ; the mode is too small. The caption fits the mode.",
      "Slip: in the captions of figure bias_graph m stands for n, the number of rays.",
      "The factor (n − 1)/n is exact where every ray ends on a leaf, below eq. (uncensored). Where most rays are "
      "censored m/Σx is only n·ln(n/(n − 1)) times too large, and the factor takes too much."};
}

std::string name_in_words(TurbidEstimator estimator) {
  switch (estimator) {
    case TurbidEstimator::naive:
      return "naive m/Σy";
    case TurbidEstimator::maximum_likelihood:
      return "maximum likelihood m/Σx";
    case TurbidEstimator::mode:
      return "mode (m−1)/Σx";
    case TurbidEstimator::debiased:
      return "de-biased (n−1)/n·m/Σx";
    case TurbidEstimator::unbiased:
      return "unbiased m/Σx − H/(Σx)²";
  }
  return {};
}

ordered_json data_of(const TurbidOptions& options, const TurbidResult& result) {
  ordered_json data = {{"experiment", "turbid"}, {"seed", options.seed}, {"trials", options.trials}};
  data["cells"] = ordered_json::array();
  for (const TurbidCell& cell : result.cells) {
    ordered_json json = {{"rays", cell.rays},
                         {"optical_depth", cell.optical_depth},
                         {"censored_share", cell.censored_share},
                         {"mean_hits", cell.rays * (1 - cell.censored_share)}};
    for (std::size_t i = 0; i < kTurbidEstimators; ++i) {
      json[name_of(TurbidEstimator(i))] = mean_json(cell.simulated[i]);
      json[name_of(TurbidEstimator(i))]["exact"] = cell.exact[i];
    }
    data["cells"].push_back(json);
  }
  data["uncensored"] = ordered_json::array();
  for (const UncensoredCell& cell : result.uncensored)
    data["uncensored"].push_back({{"rays", cell.rays},
                                  {"maximum_likelihood", mean_json(cell.maximum_likelihood)},
                                  {"debiased", mean_json(cell.debiased)},
                                  {"debiased_deviation", cell.debiased_deviation},
                                  {"paper_deviation", cell.exact_deviation}});
  data["notes"] = notes();
  return data;
}

std::string text_of(const TurbidOptions& options, const TurbidResult& result) {
  std::string text = fmt::format(
      "Turbid medium in one dimension, {} trials per cell, seed {}: (E[λ̂] − λ)/λ in %, simulated ± standard error, and "
      "exact by numerical integration in brackets\n\n",
      options.trials, options.seed);
  std::vector<std::string> heads = {"rays n", "λy", "censored, %", "mean hits"};
  for (std::size_t i = 0; i < kTurbidEstimators; ++i) heads.push_back(name_in_words(TurbidEstimator(i)));
  TextTable table(heads);
  for (const TurbidCell& cell : result.cells) {
    std::vector<std::string> line = {fmt::format("{}", cell.rays), fmt::format("{:g}", cell.optical_depth),
                                     fmt::format("{:.1f}", 100 * cell.censored_share),
                                     fmt::format("{:.2g}", cell.rays * (1 - cell.censored_share))};
    for (std::size_t i = 0; i < kTurbidEstimators; ++i)
      line.push_back(fmt::format("{} ({})", percent(cell.simulated[i], 2), percent(cell.exact[i], 2)));
    table.add(line);
  }
  text += table.text() + "\nWithout censoring (y = ∞), where the paper's λ̂ = (n − 1)/Σx is unbiased:\n\n";
  TextTable endless({"rays n", "maximum likelihood, %", "paper: 1/(n − 1), %", "de-biased, %", "its deviation σ/λ",
                     "paper: 1/√(n − 2)"});
  for (const UncensoredCell& cell : result.uncensored)
    endless.add({fmt::format("{}", cell.rays), percent(cell.maximum_likelihood, 2), percent(1.0 / (cell.rays - 1), 2),
                 percent(cell.debiased, 2), fmt::format("{:.3f}", cell.debiased_deviation),
                 std::isfinite(cell.exact_deviation) ? fmt::format("{:.3f}", cell.exact_deviation) : "∞"});
  return text + endless.text() + "\n" + notes_text(notes());
}

ExperimentChart chart_of(const TurbidOptions& options, const TurbidResult& result) {
  ExperimentChart out{"turbid",
                      "Turbid medium in one dimension",
                      fmt::format("Normalised error of λ̂, {} trials per point; lines: exact", options.trials),
                      {}};
  out.chart.x_title = "optical depth of the voxel, λy (logarithmic)", out.chart.y_title = "(E[λ̂] − λ)/λ, %";
  out.chart.x_ticks = options.optical_depths, out.chart.logarithmic_x = true;
  for (std::size_t i = 0; i < kTurbidEstimators; ++i) {
    formats::ChartPanel panel{name_in_words(TurbidEstimator(i)), {}};
    for (const int rays : options.rays) {
      formats::ChartSeries simulated{fmt::format("n = {}", rays), {}, formats::SeriesMark::discs};
      formats::ChartSeries exact{simulated.name, {}, formats::SeriesMark::line};
      for (const TurbidCell& cell : result.cells) {
        if (cell.rays != rays) continue;
        simulated.points.push_back(
            {cell.optical_depth, 100 * cell.simulated[i].value, 100 * cell.simulated[i].standard_error});
        exact.points.push_back({cell.optical_depth, 100 * cell.exact[i], 0});
      }
      panel.series.push_back(simulated), panel.series.push_back(exact);
    }
    out.chart.panels.push_back(panel);
  }
  return out;
}

}  // namespace

Result<ExperimentReport> report_turbid(const ExperimentRequest& request, Progress& progress) {
  TurbidOptions options;
  options.seed = request.seed, options.threads = request.threads;
  options.trials = request.trials.value_or(options.trials);
  RAYFIELD_ASSIGN(const TurbidResult result, run_turbid(options, progress));
  return ExperimentReport{data_of(options, result), text_of(options, result), {chart_of(options, result)}};
}

}  // namespace rayfield::cli
