#include <fmt/core.h>

#include <algorithm>

#include "cli/commands/commands.h"
#include "cli/commands/store_command.h"
#include "cli/console/alignment_text.h"
#include "cli/console/beam_text.h"
#include "cli/console/text.h"
#include "rayfield/core/date.h"
#include "rayfield/density/registry.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

using nlohmann::ordered_json;

bool is_processed(const tile::ScanEntry& scan) {
  return std::any_of(scan.derived.begin(), scan.derived.end(),
                     [](const tile::DerivedEntry& entry) { return entry.kind == "results"; });
}

// Everything that the store knows about one scan, for --json.
ordered_json scan_json(const tile::ScanEntry& scan) {
  std::uint64_t bytes = 0, segments = 0;
  for (const tile::TileEntry& entry : scan.tiles) {
    segments += entry.segment_count;
    bytes += entry.file.size;
    for (const tile::FileEntry& file : entry.more_files) bytes += file.size;
  }
  ordered_json derived = ordered_json::object();
  for (const tile::DerivedEntry& entry : scan.derived) derived[entry.kind] = derived.value(entry.kind, 0) + 1;
  ordered_json files = ordered_json::array();
  for (const tile::AttachmentEntry& kept : scan.attachments)
    files.push_back({{"name", kept.name}, {"path", kept.file.path}, {"bytes", kept.file.size}});
  ordered_json json = {
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
      {"dormant", scan.dormant ? ordered_json(*scan.dormant) : ordered_json(nullptr)},
      {"files", files},
      {"warnings", scan.warnings}};
  if (scan.alignment) json["alignment"] = alignment_json(*scan.alignment);
  if (scan.beam) json["beam"] = beam_json(*scan.beam);
  return json;
}

}  // namespace

Result<Outcome> store_status(const std::string& folder) {
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(folder));
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const density::BlockNames names, density::read_names(store, snapshot));
  Outcome outcome;
  outcome.data = {{"store", folder},
                  {"block", names.block},
                  {"crs", store.config().crs},
                  {"tile_size_m", store.config().tile_size_m},
                  {"snapshot", snapshot.number},
                  {"scans", ordered_json::array()}};
  outcome.text = fmt::format("{}: {}, {} scan{}, snapshot {}\n", names.block, store.config().crs, snapshot.scans.size(),
                             snapshot.scans.size() == 1 ? "" : "s", snapshot.number);
  for (const tile::ScanEntry& scan : snapshot.scans) {
    const ordered_json entry = scan_json(scan);
    outcome.text +=
        fmt::format("  {}  {} rays in {} tiles, {} ({:.1f} B/ray){}\n", scan.scan_id, grouped(scan.ray_count),
                    scan.tiles.size(), bytes_text(entry["ray_bytes"].get<std::uint64_t>()),
                    entry["bytes_per_ray"].get<double>(), is_processed(scan) ? ", processed" : ", not processed");
    if (scan.alignment) outcome.text += fmt::format("    {}\n", alignment_text(*scan.alignment));
    if (scan.beam) outcome.text += fmt::format("    beam: {}\n", beam_text(*scan.beam));
    for (const tile::AttachmentEntry& kept : scan.attachments)
      outcome.text += fmt::format("    kept: {}, {}\n", kept.name, bytes_text(kept.file.size));
    for (const std::string& warning : scan.warnings) outcome.text += fmt::format("    note: {}\n", warning);
    outcome.data["scans"].push_back(entry);
  }
  return outcome;
}

void add_status_command(Commands& commands) {
  add_store_command(commands, "status", "What a store holds",
                    [](const std::string& folder, Context&) { return store_status(folder); });
}

}  // namespace rayfield::cli
