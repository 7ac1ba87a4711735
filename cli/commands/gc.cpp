#include <fmt/core.h>

#include "cli/commands/commands.h"
#include "cli/commands/store_command.h"
#include "cli/console/text.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

Result<Outcome> run_gc(const std::string& folder, const Context& context) {
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::open(folder));
  RAYFIELD_ASSIGN(const std::uint64_t freed, store.gc(context.options.dry_run));
  Outcome outcome;
  outcome.data = {{"store", folder}, {"bytes_freed", freed}, {"dry_run", context.options.dry_run}};
  outcome.text = fmt::format("{} {}\n", context.options.dry_run ? "would free" : "freed", bytes_text(freed));
  return outcome;
}

}  // namespace

void add_gc_command(Commands& commands) {
  add_store_command(commands, "gc", "Remove files that no snapshot names",
                    [](const std::string& folder, Context& context) { return run_gc(folder, context); });
}

}  // namespace rayfield::cli
