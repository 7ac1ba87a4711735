#include <fmt/core.h>

#include <memory>

#include "cli/commands/commands.h"
#include "cli/console/option_settings.h"
#include "cli/console/text.h"
#include "cli/products/report_block.h"
#include "rayfield/formats/text_output.h"

namespace rayfield::cli {
namespace {

struct ReportArguments {
  std::string store, file;
  std::vector<std::string> dates, settings;
};

Result<Outcome> run_report(const ReportArguments& arguments, const Context& context) {
  ReportRequest request{arguments.dates, {}};
  RAYFIELD_CHECK(apply_settings(arguments.settings, request.settings));
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(arguments.store));
  RAYFIELD_CHECK(check_report_target(arguments.file, context.options.overwrite));
  Outcome outcome;
  outcome.data = {{"store", arguments.store}, {"file", arguments.file}, {"dry_run", context.options.dry_run}};
  if (context.options.dry_run) {
    outcome.text = fmt::format("Would write a report of {} to {}\n", arguments.store, arguments.file);
    return outcome;
  }
  RAYFIELD_ASSIGN(const formats::BlockReport report, load_report(store, request, context.progress));
  RAYFIELD_ASSIGN(const std::string html, formats::report_html(report));
  RAYFIELD_CHECK(formats::write_text_file(arguments.file, html, "cannot write report"));
  outcome.data["snapshot"] = report.block.snapshot;
  outcome.data["bytes"] = html.size();
  outcome.data["panels"] = report.block.panels.size();
  outcome.data["dates"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < report.scans.size(); ++i)
    outcome.data["dates"].push_back({{"scan_id", report.block.scans[i].scan.scan_id},
                                     {"date", report.block.scans[i].scan.scan_date},
                                     {"dormant", report.scans[i].dormant},
                                     {"gaps", report.scans[i].gaps.size()}});
  outcome.text = fmt::format("{}: {} panels, {} dates, {}\n", arguments.file, report.block.panels.size(),
                             report.scans.size(), bytes_text(html.size()));
  return outcome;
}

}  // namespace

void add_report_command(Commands& commands) {
  const auto arguments = std::make_shared<ReportArguments>();
  CLI::App* command = commands.add("report", "Write a block with all its dates as one HTML file that needs no network",
                                   "rayfield report myblock -o report.html",
                                   [arguments](Context& context) { return run_report(*arguments, context); });
  command->add_option("STORE", arguments->store, "Folder of the store")->required();
  command->add_option("-o,--output", arguments->file, "File to write; a report that is there is replaced")->required();
  add_dates_option(*command, arguments->dates, "Only these dates or scans (default: all)");
  add_settings_option(*command, arguments->settings);
}

}  // namespace rayfield::cli
