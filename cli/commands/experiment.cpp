#include <fmt/core.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/console/output_paths.h"
#include "cli/experiments/experiment_report.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

struct ExperimentArguments {
  std::string name, folder;
  ExperimentRequest request;
};

struct Experiment {
  const char* name;
  Result<ExperimentReport> (*run)(const ExperimentRequest&, Progress&);
  std::vector<std::string> charts;
};
const std::array<Experiment, 4>& all_experiments() {
  static const std::array<Experiment, 4> kAll{
      {{"turbid", report_turbid, {"turbid"}},
       {"triangles", report_triangles, {"triangles_few_rays", "triangles_surface"}},
       {"spinning", report_spinning, {"spinning"}},
       {"beam", report_beam, {"beam_3", "beam_8"}}}};
  return kAll;
}

const Experiment& experiment_named(const std::string& name) {
  for (const Experiment& experiment : all_experiments())
    if (name == experiment.name) return experiment;
  return all_experiments().front();
}

/// Makes the folder, and sees that nothing in the way of its files turns up after the experiment.
Result<OutputFolder> prepare_folder(const ExperimentArguments& arguments, const Experiment& experiment,
                                    bool overwrite) {
  RAYFIELD_ASSIGN(OutputFolder made, OutputFolder::make(arguments.folder));
  std::vector<OutputPath> outputs;
  for (const std::string& chart : experiment.charts)
    for (const char* ending : {".png", ".svg"})
      outputs.push_back({"--output", "cannot write picture", (fs::path(arguments.folder) / (chart + ending)).string()});
  RAYFIELD_CHECK(check_outputs(outputs, {}, overwrite));
  return made;
}

Result<Outcome> run_experiment(const ExperimentArguments& arguments, const Context& context) {
  const Experiment& experiment = experiment_named(arguments.name);
  Outcome outcome;
  if (context.options.dry_run) {
    outcome.data = {{"experiment", arguments.name}, {"dry_run", true}};
    outcome.text = fmt::format("Would run the experiment {}\n", arguments.name);
    return outcome;
  }
  std::optional<OutputFolder> made;
  if (!arguments.folder.empty()) {
    RAYFIELD_ASSIGN(OutputFolder folder, prepare_folder(arguments, experiment, context.options.overwrite));
    made.emplace(std::move(folder));
  }
  ExperimentRequest request = arguments.request;
  request.threads = context.options.threads;
  RAYFIELD_ASSIGN(const ExperimentReport report, experiment.run(request, context.progress));
  outcome.data = report.data, outcome.text = report.text;
  outcome.data["files"] = nlohmann::ordered_json::array();
  if (arguments.folder.empty()) return outcome;
  for (const ExperimentChart& chart : report.charts)
    for (const char* ending : {".png", ".svg"}) {
      const std::string path = (fs::path(arguments.folder) / (chart.name + ending)).string();
      formats::PictureOptions options;
      options.title = chart.title, options.subtitle = chart.subtitle;
      RAYFIELD_CHECK(formats::write_series_chart(chart.chart, path, options));
      outcome.data["files"].push_back(path);
      outcome.text += path + "\n";
    }
  return outcome;
}

}  // namespace

void add_experiment_command(Commands& commands) {
  const auto arguments = std::make_shared<ExperimentArguments>();
  CLI::App* command = commands.add(
      "experiment", "Monte-Carlo experiments on the estimators of density, beside the figures of the paper",
      "rayfield experiment spinning -o charts",
      [arguments](Context& context) { return run_experiment(*arguments, context); });
  command
      ->add_option("NAME", arguments->name,
                   "turbid: rays in a turbid medium; triangles: leaves of real size in a voxel; spinning: trawling and "
                   "spinning lidar; beam: wide beams, with and without their correction")
      ->required()
      ->transform(CLI::IsMember({"turbid", "triangles", "spinning", "beam"}, CLI::ignore_case));
  command->add_option("-o,--output", arguments->folder, "Folder for charts, as PNG and SVG (default: only the tables)");
  command->add_option("--seed", arguments->request.seed, "Of the random numbers, up to 2^53 (default 1)")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 53).description(""))
      ->type_name("N");
  command
      ->add_option("--trials", arguments->request.trials,
                   "Trials per cell (default: turbid 1000000, triangles and spinning 20000, beam 4: 7, 20, 15 and 60 s "
                   "on one core); time grows with them")
      ->check(CLI::Range(std::int64_t{2}, std::int64_t{1'000'000'000}).description(""))
      ->type_name("N");
}

}  // namespace rayfield::cli
