#include <fmt/core.h>

#include <memory>

#include "cli/commands/commands.h"
#include "cli/commands/store_command.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

Result<Outcome> run_remove(const std::string& folder, const std::string& scan, const Context& context) {
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::open(folder));
  Outcome outcome;
  if (context.options.dry_run) {
    RAYFIELD_ASSIGN(const std::string scan_id, store.find_scan_to_remove(scan));
    outcome.data = {{"store", folder}, {"scan_id", scan_id}, {"dry_run", true}};
    outcome.text = fmt::format("Would remove {}\n", scan_id);
    return outcome;
  }
  RAYFIELD_ASSIGN(const tile::RemoveReport report, store.remove(scan, context.command_line));
  outcome.data = {{"store", folder},
                  {"scan_id", report.scan_id},
                  {"snapshot", report.snapshot},
                  {"already_gone", report.already_gone}};
  outcome.text = report.already_gone
                     ? fmt::format("{}: removed before; nothing to do\n", report.scan_id)
                     : fmt::format("{}: removed in snapshot {}; `rayfield revert {} {}` brings it back\n",
                                   report.scan_id, report.snapshot, folder, report.snapshot - 1);
  return outcome;
}

}  // namespace

void add_remove_command(Commands& commands) {
  const auto scan = std::make_shared<std::string>();
  CLI::App* command = add_store_command(
      commands, "remove", "Take a scan out of a store; older snapshots keep it",
      [scan](const std::string& folder, Context& context) { return run_remove(folder, *scan, context); },
      "rayfield remove myblock 2019-02-11");
  command->add_option("SCAN", *scan, "Scan id, or a date on which there is one scan")->required();
}

}  // namespace rayfield::cli
