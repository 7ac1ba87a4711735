#include <fmt/core.h>

#include <memory>

#include "cli/commands/commands.h"
#include "cli/products/report_block.h"
#include "rayfield/align/options.h"
#include "rayfield/core/option_fields.h"
#include "rayfield/density/comparison.h"
#include "rayfield/density/process.h"
#include "rayfield/density/zones.h"
#include "rayfield/slam/slam.h"

namespace rayfield::cli {
namespace {

// A Markdown table of one command's options: docs/options.md is made of these, and a test holds it against them.
std::string markdown_table(const std::vector<OptionDescription>& fields) {
  std::string text = "| key | default | range | meaning |\n|---|---|---|---|\n";
  for (const OptionDescription& field : fields)
    text += fmt::format("| `{}` | {} | {} | {} |\n", field.key, field.default_value, field.range, field.meaning);
  return text;
}

Result<Outcome> run_options(const std::string& wanted) {
  const std::vector<std::pair<std::string, std::vector<OptionDescription>>> commands{
      {"process", describe_options<density::ProcessOptions>()},
      {"slam", describe_options<slam::SlamOptions>()},
      {"add", describe_options<align::AlignOptions>()},
      {"compare", describe_options<density::ComparisonOptions>()},
      {"report", describe_options<ReportSettings>()},
      {"zones", describe_options<density::ZoneOptions>()}};
  Outcome outcome;
  outcome.data = nlohmann::ordered_json::object();
  for (const auto& [command, fields] : commands) {
    if (!wanted.empty() && wanted != command) continue;
    outcome.text += fmt::format("{}## `{}`\n\n{}", outcome.text.empty() ? "" : "\n", command, markdown_table(fields));
    for (const OptionDescription& field : fields)
      outcome.data[command].push_back(
          {{"key", field.key}, {"default", field.default_value}, {"range", field.range}, {"meaning", field.meaning}});
  }
  return outcome;
}

}  // namespace

void add_options_command(Commands& commands) {
  const auto wanted = std::make_shared<std::string>();
  CLI::App* command =
      commands.add("options", "List the options that --set and configuration files take, with defaults and ranges",
                   "rayfield options process", [wanted](Context&) { return run_options(*wanted); });
  command->add_option("COMMAND", *wanted, "process, slam, add, compare, report or zones (default: all)")
      ->transform(CLI::IsMember({"process", "slam", "add", "compare", "report", "zones"}, CLI::ignore_case));
}

}  // namespace rayfield::cli
