#include <fmt/core.h>

#include "cli/commands/commands.h"
#include "cli/commands/store_command.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

Result<Outcome> run_log(const std::string& folder) {
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(folder));
  RAYFIELD_ASSIGN(const std::vector<tile::Snapshot> history, store.history());
  Outcome outcome;
  outcome.data = {{"store", folder}, {"snapshots", nlohmann::ordered_json::array()}};
  for (auto snapshot = history.rbegin(); snapshot != history.rend(); ++snapshot) {
    outcome.data["snapshots"].push_back({{"number", snapshot->number},
                                         {"parent", snapshot->parent},
                                         {"created_utc", snapshot->created_utc},
                                         {"software_version", snapshot->software_version},
                                         {"command", snapshot->command},
                                         {"scans", snapshot->scans.size()}});
    outcome.text += fmt::format("{:>6}  {}  {} scan{}  {}\n", snapshot->number, snapshot->created_utc,
                                snapshot->scans.size(), snapshot->scans.size() == 1 ? " " : "s", snapshot->command);
  }
  if (history.empty()) outcome.text = "nothing has been added yet\n";
  return outcome;
}

}  // namespace

void add_log_command(Commands& commands) {
  add_store_command(commands, "log", "The history of a store, newest first",
                    [](const std::string& folder, Context&) { return run_log(folder); });
}

}  // namespace rayfield::cli
