#include <fmt/format.h>

#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/console/output_paths.h"
#include "cli/products/exchange_products.h"
#include "cli/products/export_block.h"
#include "cli/products/export_needs.h"

namespace rayfield::cli {
namespace {

struct ExportArguments {
  std::string store, folder;
  std::vector<std::string> formats, profiles, dates;
  std::optional<std::uint64_t> snapshot;
};

Result<Outcome> run_export(const ExportArguments& arguments, const Context& context) {
  RAYFIELD_CHECK(check_outside_stores(arguments.folder, "cannot export", "give another -o"));
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(arguments.store));
  Outcome outcome;
  outcome.data = {{"store", arguments.store},
                  {"folder", arguments.folder},
                  {"dry_run", context.options.dry_run},
                  {"files", nlohmann::ordered_json::array()}};
  ExportOptions options;
  if (!arguments.formats.empty() || !arguments.profiles.empty())
    options.formats = {arguments.formats.begin(), arguments.formats.end()};
  options.profiles = {arguments.profiles.begin(), arguments.profiles.end()};
  options.dates = arguments.dates;
  options.snapshot = arguments.snapshot;
  options.overwrite = context.options.overwrite;
  options.threads = context.options.threads, options.memory_bytes = context.options.memory_bytes;
  if (context.options.dry_run) {
    RAYFIELD_ASSIGN(const Needs needs, export_needs(store, options));
    outcome.text = fmt::format("Would export {} to {}\n", arguments.store, arguments.folder);
    add_needs(needs, arguments.folder, outcome);
    return outcome;
  }
  RAYFIELD_ASSIGN(const ExportReport report, export_block(store, arguments.folder, options, context.progress));
  outcome.data["snapshot"] = report.snapshot;
  for (const auto& path : report.products) {
    outcome.data["files"].push_back(path.string());
    outcome.text += path.string() + "\n";
  }
  return outcome;
}

}  // namespace

void add_export_command(Commands& commands) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = commands.add("export", "Write the products of a processed block",
                                   "rayfield export myblock -o maps --date 2019-02-11",
                                   [arguments](Context& context) { return run_export(*arguments, context); });
  command->add_option("STORE", arguments->store, "Folder of the store")->required();
  command->add_option("-o,--output", arguments->folder, "Folder to write to")->required();
  add_dates_option(*command, arguments->dates, "Only these dates or scans (default: all)");
  command
      ->add_option("--snapshot", arguments->snapshot,
                   "Number of the snapshot to export, see `rayfield log` (default: the newest)")
      ->check(snapshot_number());
  command->add_option("--format", arguments->formats, "Formats (default: geotiff, gpkg, png; none with --profile)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(CLI::IsMember(export_formats(), CLI::ignore_case));
  command->add_option("--profile", arguments->profiles, "Zipped shapefiles after the rules of farm systems")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(CLI::IsMember(profile_names(), CLI::ignore_case));
}

}  // namespace rayfield::cli
