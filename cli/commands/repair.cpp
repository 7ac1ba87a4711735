#include <fmt/core.h>

#include "cli/commands/commands.h"
#include "cli/commands/store_command.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

nlohmann::ordered_json list_of(const std::vector<tile::Damage>& damages) {
  auto list = nlohmann::ordered_json::array();
  for (const tile::Damage& damage : damages) list.push_back({{"path", damage.path}, {"reason", damage.reason}});
  return list;
}

// What was wrong, what came back, and what did not: a store of which something stays lost ends with exit code 4.
Result<Outcome> run_repair(const std::string& folder, Context& context) {
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::open(folder));
  const bool dry_run = context.options.dry_run;
  RAYFIELD_ASSIGN(const tile::RepairReport report, store.repair(dry_run, context.command_line, context.progress));
  Outcome outcome;
  outcome.data = {{"store", folder},
                  {"dry_run", dry_run},
                  {"found", list_of(report.found)},
                  {"snapshot", report.snapshot},
                  {"rebuilt", report.rebuilt},
                  {"left_out", list_of(report.left_out)}};
  if (report.found.empty()) {
    outcome.text = "the history is whole; nothing to repair\n";
    return outcome;
  }
  for (const tile::Damage& damage : report.found)
    outcome.text += fmt::format("found: {}: {}\n", damage.path, damage.reason);
  for (const std::string& scan : report.rebuilt)
    outcome.text += fmt::format("{}: {} from its files\n", scan, dry_run ? "would be made again" : "made again");
  for (const tile::Damage& left_out : report.left_out)
    outcome.failures.push_back(fmt::format("left out: {}: {}", left_out.path, left_out.reason));
  if (report.snapshot == 0) outcome.failures.emplace_back("nothing that could be repaired: look at `rayfield log`");
  for (const std::string& failure : outcome.failures) outcome.text += failure + "\n";
  if (report.snapshot != 0)
    outcome.text += fmt::format("{} snapshot {}; `rayfield verify --all` and `rayfield process` come next\n",
                                dry_run ? "would publish" : "published", report.snapshot);
  if (report.snapshot == 0 || !report.left_out.empty())
    outcome.data["exit_code"] = static_cast<int>(ErrorCode::damaged);
  return outcome;
}

}  // namespace

void add_repair_command(Commands& commands) {
  add_store_command(
      commands, "repair", "Go on from a history of which snapshots are missing; rebuilds scans from files",
      [](const std::string& folder, Context& context) { return run_repair(folder, context); },
      "rayfield repair myblock --dry-run");
}

}  // namespace rayfield::cli
