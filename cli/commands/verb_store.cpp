// The commands that only concern the store: init, status, log, verify, gc.
#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "cli/commands/verbs.h"
#include "cli/console/text.h"
#include "rayfield/core/date.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

using nlohmann::ordered_json;

Result<Outcome> run_init(const std::string& folder, const tile::StoreConfig& config, const Context& context) {
  RAYFIELD_CHECK(config.validate());
  RAYFIELD_ASSIGN(const CrsInfo crs, lookup_projected_crs(config.crs));
  if (std::filesystem::exists(std::filesystem::path(folder) / "store.json"))
    return fail(ErrorCode::usage, "cannot make a store", folder, "there is one already",
                "see `rayfield status`, or give another folder");
  if (!context.options.dry_run) RAYFIELD_CHECK(tile::Store::create(folder, config));
  Outcome outcome;
  outcome.data = {{"store", folder},
                  {"crs", crs.code},
                  {"crs_name", crs.name},
                  {"tile_size_m", config.tile_size_m},
                  {"dry_run", context.options.dry_run}};
  outcome.text = fmt::format("{} {}: {} ({}), tiles of {} m\n", context.options.dry_run ? "Would make" : "Made", folder,
                             crs.code, crs.name, config.tile_size_m);
  return outcome;
}

ordered_json scan_json(const tile::ScanEntry& scan) {
  std::uint64_t bytes = 0, segments = 0;
  for (const tile::TileEntry& entry : scan.tiles) {
    segments += entry.segment_count;
    bytes += entry.file.size;
    for (const tile::FileEntry& file : entry.more_files) bytes += file.size;
  }
  ordered_json derived = ordered_json::object();
  for (const tile::DerivedEntry& entry : scan.derived) derived[entry.kind] = derived.value(entry.kind, 0) + 1;
  return {
      {"scan_id", scan.scan_id},
      {"date", scan.date},
      {"name", scan.name},
      {"start_utc", utc_text(scan.start_time_s)},
      {"end_utc", utc_text(scan.end_time_s)},
      {"rays", scan.ray_count},
      {"hits", scan.hit_count},
      {"segments", segments},
      {"tiles", scan.tiles.size()},
      {"ray_bytes", bytes},
      {"bytes_per_ray", scan.ray_count > 0 ? static_cast<double>(bytes) / static_cast<double>(scan.ray_count) : 0.0},
      {"derived", derived},
      {"warnings", scan.warnings}};
}

Result<Outcome> run_log(const std::string& folder) {
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(folder));
  RAYFIELD_ASSIGN(const std::vector<tile::Snapshot> history, store.history());
  Outcome outcome;
  outcome.data = {{"store", folder}, {"snapshots", ordered_json::array()}};
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

Result<Outcome> run_verify(const std::string& folder, bool all, const Context& context) {
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(folder));
  RAYFIELD_ASSIGN(const std::vector<tile::Damage> damages,
                  store.verify(all, context.options.threads, context.progress));
  Outcome outcome;
  outcome.data = {{"store", folder}, {"ok", damages.empty()}, {"damaged", ordered_json::array()}};
  for (const tile::Damage& damage : damages) {
    outcome.data["damaged"].push_back({{"path", damage.path}, {"reason", damage.reason}});
    outcome.text += fmt::format("damaged: {}: {}\n", damage.path, damage.reason);
  }
  if (damages.empty()) {
    outcome.text = "all files are as they were written\n";
  } else {
    outcome.text += fmt::format(
        "{} damaged file{}; derived files come back with `rayfield process`, ray tiles need the "
        "scan to be added again with --overwrite\n",
        damages.size(), damages.size() == 1 ? "" : "s");
    outcome.data["exit_code"] = static_cast<int>(ErrorCode::damaged);
  }
  return outcome;
}

Result<Outcome> run_gc(const std::string& folder, const Context& context) {
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::open(folder));
  RAYFIELD_ASSIGN(const std::uint64_t freed, store.gc(context.options.dry_run));
  Outcome outcome;
  outcome.data = {{"store", folder}, {"bytes_freed", freed}, {"dry_run", context.options.dry_run}};
  outcome.text = fmt::format("{} {}\n", context.options.dry_run ? "would free" : "freed", bytes_text(freed));
  return outcome;
}

// A command whose only own argument is the store.
CLI::App* add_store_command(Commands& commands, const std::string& name, const std::string& description,
                            std::function<Result<Outcome>(const std::string&, Context&)> run) {
  const auto folder = std::make_shared<std::string>();
  CLI::App* command = commands.add(name, description, "rayfield " + name + " myblock",
                                   [folder, run = std::move(run)](Context& context) { return run(*folder, context); });
  command->add_option("STORE", *folder, "Folder of the store")->required();
  return command;
}

}  // namespace

Result<Outcome> store_status(const std::string& folder) {
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(folder));
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  Outcome outcome;
  outcome.data = {{"store", folder},
                  {"block", store.block_name()},
                  {"crs", store.config().crs},
                  {"tile_size_m", store.config().tile_size_m},
                  {"snapshot", snapshot.number},
                  {"scans", ordered_json::array()}};
  outcome.text = fmt::format("{}: {}, {} scan{}, snapshot {}\n", store.block_name(), store.config().crs,
                             snapshot.scans.size(), snapshot.scans.size() == 1 ? "" : "s", snapshot.number);
  for (const tile::ScanEntry& scan : snapshot.scans) {
    const ordered_json entry = scan_json(scan);
    outcome.text +=
        fmt::format("  {}  {} rays in {} tiles, {} ({:.1f} B/ray){}\n", scan.scan_id, grouped(scan.ray_count),
                    scan.tiles.size(), bytes_text(entry["ray_bytes"].get<std::uint64_t>()),
                    entry["bytes_per_ray"].get<double>(), scan.derived.empty() ? ", not processed" : ", processed");
    for (const std::string& warning : scan.warnings) outcome.text += fmt::format("    note: {}\n", warning);
    outcome.data["scans"].push_back(entry);
  }
  return outcome;
}

void add_init_verb(Commands& commands) {
  const auto folder = std::make_shared<std::string>();
  const auto config = std::make_shared<tile::StoreConfig>();
  CLI::App* command = commands.add("init", "Make an empty store for a block", "rayfield init myblock --crs EPSG:7854",
                                   [folder, config](Context& context) { return run_init(*folder, *config, context); });
  command->add_option("STORE", *folder, "Folder to make")->required();
  command->add_option("--crs", config->crs, "Projected coordinate reference system in metres, e.g. EPSG:7854")
      ->required();
  command->add_option("--tile-size", config->tile_size_m, "Side of a tile, m")->capture_default_str();
}

void add_status_verb(Commands& commands) {
  add_store_command(commands, "status", "What a store holds",
                    [](const std::string& folder, Context&) { return store_status(folder); });
}

void add_log_verb(Commands& commands) {
  add_store_command(commands, "log", "The history of a store, newest first",
                    [](const std::string& folder, Context&) { return run_log(folder); });
}

void add_verify_verb(Commands& commands) {
  const auto all = std::make_shared<bool>(false);
  CLI::App* command = add_store_command(
      commands, "verify", "Check every file of a store against its size and SHA-256; exit code 4 if one is damaged",
      [all](const std::string& folder, Context& context) { return run_verify(folder, *all, context); });
  command->add_flag("--all", *all, "Also files that only older snapshots name");
}

void add_gc_verb(Commands& commands) {
  add_store_command(commands, "gc", "Remove files that no snapshot names",
                    [](const std::string& folder, Context& context) { return run_gc(folder, context); });
}

}  // namespace rayfield::cli
