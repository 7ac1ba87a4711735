#include <fmt/core.h>
#include <fmt/ranges.h>

#include <memory>

#include "cli/commands/commands.h"
#include "cli/commands/store_command.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

Result<Outcome> run_revert(const std::string& folder, std::uint64_t number, const Context& context) {
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::open(folder));
  Outcome outcome;
  if (context.options.dry_run) {
    RAYFIELD_ASSIGN(const tile::Snapshot old, store.snapshot(number));
    outcome.data = {{"store", folder}, {"reverted_to", number}, {"scans", old.scans.size()}, {"dry_run", true}};
    outcome.text = fmt::format("Would revert to snapshot {} with {} scan{}\n", number, old.scans.size(),
                               old.scans.size() == 1 ? "" : "s");
    return outcome;
  }
  RAYFIELD_ASSIGN(const tile::RevertReport report, store.revert(number, context.command_line));
  outcome.data = {{"store", folder},
                  {"reverted_to", number},
                  {"snapshot", report.snapshot},
                  {"already_there", report.already_there},
                  {"scans", report.scans}};
  outcome.text = report.already_there
                     ? fmt::format("the store is as in snapshot {} already; nothing to do\n", number)
                     : fmt::format("snapshot {} is as snapshot {}: {}\n", report.snapshot, number,
                                   report.scans.empty() ? "no scan" : fmt::format("{}", fmt::join(report.scans, ", ")));
  return outcome;
}

}  // namespace

void add_revert_command(Commands& commands) {
  const auto number = std::make_shared<std::uint64_t>(0);
  CLI::App* command = add_store_command(
      commands, "revert", "Make a store hold what it held in an older snapshot; nothing is deleted",
      [number](const std::string& folder, Context& context) { return run_revert(folder, *number, context); },
      "rayfield revert myblock 12");
  command->add_option("SNAPSHOT", *number, "Number of the snapshot, see `rayfield log`")
      ->required()
      ->check(snapshot_number());
}

}  // namespace rayfield::cli
