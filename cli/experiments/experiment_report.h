#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/chart.h"

/// experiments: what `rayfield experiment` says of each Monte-Carlo experiment, with the paper's figures beside.
namespace rayfield::cli {

struct ExperimentRequest {
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> trials;  ///< absent: the experiment's own number
  int threads = 0;
};

/// A chart and what stands over it.
struct ExperimentChart {
  std::string name;  ///< of its file, without ending
  std::string title, subtitle;
  formats::SeriesChart chart;
};

struct ExperimentReport {
  nlohmann::ordered_json data;  ///< options, cells with standard errors, the paper's figures, notes
  std::string text;             ///< the same as Markdown
  std::vector<ExperimentChart> charts;
};

/// Each runs one experiment. Errors: usage (trials out of range), interrupted, resources.
Result<ExperimentReport> report_turbid(const ExperimentRequest& request, Progress& progress);
Result<ExperimentReport> report_triangles(const ExperimentRequest& request, Progress& progress);
Result<ExperimentReport> report_spinning(const ExperimentRequest& request, Progress& progress);
Result<ExperimentReport> report_beam(const ExperimentRequest& request, Progress& progress);

}  // namespace rayfield::cli
