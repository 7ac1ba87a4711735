#include <fmt/core.h>

#include <memory>

#include "cli/commands/commands.h"
#include "cli/commands/store_command.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

Result<Outcome> run_verify(const std::string& folder, bool all, const Context& context) {
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(folder));
  RAYFIELD_ASSIGN(const std::vector<tile::Damage> damages,
                  store.verify(all, context.options.threads, context.progress));
  Outcome outcome;
  outcome.data = {{"store", folder}, {"ok", damages.empty()}, {"damaged", nlohmann::ordered_json::array()}};
  for (const tile::Damage& damage : damages) {
    outcome.data["damaged"].push_back({{"path", damage.path}, {"reason", damage.reason}});
    outcome.failures.push_back(fmt::format("damaged: {}: {}", damage.path, damage.reason));
    outcome.text += outcome.failures.back() + "\n";
  }
  if (damages.empty()) {
    outcome.text = "all files are as they were written\n";
  } else {
    outcome.text += fmt::format(
        "{} damaged file{}; derived files come back with `rayfield process`, ray tiles need the "
        "scan to be added again with --overwrite, snapshots need `rayfield repair`\n",
        damages.size(), damages.size() == 1 ? "" : "s");
    outcome.data["exit_code"] = static_cast<int>(ErrorCode::damaged);
  }
  return outcome;
}

}  // namespace

void add_verify_command(Commands& commands) {
  const auto all = std::make_shared<bool>(false);
  CLI::App* command = add_store_command(
      commands, "verify", "Check the history and every file of a store; exit code 4 if something is damaged or missing",
      [all](const std::string& folder, Context& context) { return run_verify(folder, *all, context); });
  command->add_flag("--all", *all, "Also files that only older snapshots name");
}

}  // namespace rayfield::cli
