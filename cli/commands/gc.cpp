#include <fmt/core.h>

#include <memory>

#include "cli/commands/commands.h"
#include "cli/commands/store_command.h"
#include "cli/console/needs.h"
#include "cli/console/text.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

// Of the program; lists of files are small beside it.
constexpr std::uint64_t kMemory = std::uint64_t{96} << 20;

// "scans/2019-02-11/rays: 12 files, 3.2 MB" for each folder; the files are ordered by path.
std::string folder_lines(const tile::GarbageReport& report) {
  std::string text;
  for (std::size_t i = 0; i < report.files.size();) {
    const std::string folder = std::filesystem::path(report.files[i].path).parent_path().generic_string();
    const bool to_trash = report.files[i].to_trash;
    std::uint64_t bytes = 0;
    std::size_t count = 0;
    for (; i < report.files.size() && std::filesystem::path(report.files[i].path).parent_path() == folder; ++i)
      bytes += report.files[i].size, ++count;
    text += fmt::format("  {}: {} file{}, {}{}\n", folder, count, count == 1 ? "" : "s", bytes_text(bytes),
                        to_trash ? ", to the trash" : "");
  }
  return text;
}

// Says what is, or would be, deleted and moved; names every file in the JSON document.
Result<Outcome> run_gc(const std::string& folder, bool empty_trash, const Context& context) {
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::open(folder));
  const bool dry_run = context.options.dry_run;
  RAYFIELD_ASSIGN(const tile::GarbageReport report, store.gc({dry_run, empty_trash}));
  Outcome outcome;
  outcome.data = {
      {"store", folder},    {"bytes_freed", report.bytes_removed},      {"bytes_moved_to_trash", report.bytes_moved},
      {"dry_run", dry_run}, {"files", nlohmann::ordered_json::array()}, {"foreign", report.foreign}};
  for (const tile::GarbageFile& file : report.files)
    outcome.data["files"].push_back({{"path", file.path}, {"bytes", file.size}, {"to_trash", file.to_trash}});
  outcome.text = fmt::format("{} {}\n", dry_run ? "would free" : "freed", bytes_text(report.bytes_removed));
  if (report.bytes_moved > 0)
    outcome.text += fmt::format("{} {} to {}/trash; `rayfield gc {} --empty-trash` deletes it\n",
                                dry_run ? "would move" : "moved", bytes_text(report.bytes_moved), folder, folder);
  outcome.text += folder_lines(report);
  if (dry_run) add_needs({0, 0, kMemory}, folder, outcome);
  for (const std::string& path : report.foreign)
    outcome.text += fmt::format("  {}: not of this store, left where it is\n", path);
  return outcome;
}

}  // namespace

void add_gc_command(Commands& commands) {
  const auto empty_trash = std::make_shared<bool>(false);
  CLI::App* command = add_store_command(
      commands, "gc", "Clear away files that no snapshot names; what cannot be made anew goes to the trash first",
      [empty_trash](const std::string& folder, Context& context) { return run_gc(folder, *empty_trash, context); },
      "rayfield gc myblock --dry-run");
  command->add_flag("--empty-trash", *empty_trash, "Also delete what earlier runs moved to the trash");
}

}  // namespace rayfield::cli
