#include "libtile/store/add_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <span>

#include "libtile/files/durable_writer.h"
#include "libtile/files/file_io.h"
#include "libtile/files/store_layout.h"
#include "libtile/files/writer_lock.h"
#include "libtile/partition/partition.h"
#include "libtile/store/snapshot_log.h"
#include "rayfield/core/date.h"
#include "rayfield/core/parallel.h"

namespace rayfield::tile {
namespace {

// What a ray takes at least in the store; less free space than this for all rays cannot be enough. A drive with real
// noise takes more, and each file is reserved before it is written.
constexpr std::uint64_t kLeastBytesPerRay = 5;

// 6 km² of tiles of 25 m. Drives that lose their place, and clouds in other units, leave tiles all over the map.
constexpr std::size_t kManyTiles = 10000;

bool same_inputs(const std::vector<InputEntry>& a, const std::vector<InputEntry>& b) {
  // Without inputs named nothing says that the rays are the same.
  return !a.empty() && std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const InputEntry& x, const InputEntry& y) {
    return x.size == y.size && x.sha256 == y.sha256;
  });
}

enum class Standing { absent, same, other };

Standing standing_of(const Snapshot& snapshot, const std::string& scan_id, const AddOptions& options) {
  const ScanEntry* scan = snapshot.find_scan(scan_id);
  if (scan == nullptr) return Standing::absent;
  return same_inputs(options.inputs, scan->inputs) ? Standing::same : Standing::other;
}

Result<void> check_disk(const RaySource& rays, const std::filesystem::path& folder) {
  const auto count = rays.ray_count();
  if (!count) return {};
  RAYFIELD_ASSIGN(const std::uint64_t available, free_space(folder));
  const std::uint64_t least = *count > UINT64_MAX / kLeastBytesPerRay ? UINT64_MAX : *count * kLeastBytesPerRay;
  if (available >= least) return {};
  return fail(ErrorCode::resources, "cannot add the scan", folder.string(),
              fmt::format("{} rays need at least {} MB on the disk, {} MB are free", *count, least / 1000000 + 1,
                          available / 1000000),
              "free some disk space and run the same command again");
}

std::vector<std::string> warnings_of(const RaySource& rays, const RayStatistics& statistics, std::size_t tiles,
                                     const StoreConfig& config) {
  std::vector<std::string> warnings = rays.warnings();
  if (statistics.not_finite > 0)
    warnings.push_back(fmt::format("{} rays dropped: coordinates or times that are not finite", statistics.not_finite));
  if (statistics.out_of_range > 0)
    warnings.push_back(
        fmt::format("{} rays dropped: coordinates or times out of any CRS's range", statistics.out_of_range));
  if (statistics.too_long > 0)
    warnings.push_back(fmt::format("{} rays dropped: longer than {} m", statistics.too_long, kMaxRayLength_m));
  if (tiles > kManyTiles)
    warnings.push_back(fmt::format("it lies in {} tiles of {} m, {:.1f} km²: check its coordinates and CRS", tiles,
                                   config.tile_size_m,
                                   static_cast<double>(tiles) * config.tile_size_m * config.tile_size_m / 1e6));
  return warnings;
}

ScanEntry scan_entry(const AddOptions& options, const std::string& scan_id, const PartitionResult& result,
                     std::vector<std::string> warnings, std::vector<AttachmentEntry> attachments) {
  const RayStatistics& statistics = result.statistics;
  ScanEntry scan;
  scan.scan_id = scan_id;
  scan.date = options.date;
  scan.name = options.name;
  scan.inputs = options.inputs;
  scan.alignment = options.alignment;
  scan.dormant = options.dormant;
  scan.beam = options.beam;
  scan.ray_count = statistics.rays;
  scan.hit_count = statistics.hits;
  scan.start_time_s = static_cast<double>(statistics.first_time_us) / 1e6;
  scan.end_time_s = static_cast<double>(statistics.last_time_us) / 1e6;
  for (const auto& corner : {statistics.origin_min, statistics.origin_max})
    scan.origin_bounds.extend(Eigen::Vector3d(static_cast<double>(corner[0]), static_cast<double>(corner[1]),
                                              static_cast<double>(corner[2])) /
                              kUnitsPerMetre);
  scan.warnings = std::move(warnings);
  scan.tiles = result.tiles;
  scan.attachments = std::move(attachments);
  return scan;
}

AddReport report_of(const ScanEntry& scan) {
  AddReport report;
  report.scan_id = scan.scan_id;
  report.ray_count = scan.ray_count;
  report.hit_count = scan.hit_count;
  report.tile_count = scan.tiles.size();
  report.warnings = scan.warnings;
  for (const TileEntry& tile : scan.tiles) {
    report.segment_count += tile.segment_count;
    report.bytes_written += tile.file.size;
    for (const FileEntry& file : tile.more_files) report.bytes_written += file.size;
  }
  for (const AttachmentEntry& attachment : scan.attachments) report.bytes_written += attachment.file.size;
  return report;
}

Result<void> check_attachments(const std::vector<NewAttachment>& attachments) {
  std::set<std::string> names;
  for (const NewAttachment& attachment : attachments)
    if (!layout::is_plain_name(attachment.name) || !names.insert(attachment.name).second)
      return fail(ErrorCode::internal, "cannot keep a file with the scan", attachment.name,
                  "names must be plain and different");
  return {};
}

Result<std::vector<AttachmentEntry>> write_attachments(DurableWriter& writer, const std::string& scan_id,
                                                       const std::vector<NewAttachment>& attachments) {
  std::vector<AttachmentEntry> entries;
  for (const NewAttachment& attachment : attachments) {
    RAYFIELD_ASSIGN(FileEntry file, writer.write(std::as_bytes(std::span(attachment.bytes)),
                                                 layout::attachment_directory(scan_id), [&](const std::string& sha256) {
                                                   return layout::attachment_file_name(attachment.name, sha256);
                                                 }));
    entries.push_back({attachment.name, std::move(file)});
  }
  std::sort(entries.begin(), entries.end(),
            [](const AttachmentEntry& a, const AttachmentEntry& b) { return a.name < b.name; });
  return entries;
}

tl::unexpected<Error> date_taken(const std::filesystem::path& store, const std::string& scan_id) {
  return fail(ErrorCode::usage, "cannot add the scan", store.string(),
              "it already holds another scan '" + scan_id + "'",
              "give --name for a second scan of that date, or --overwrite");
}

// The snapshot with the scan in it. A scan that replaces one of the same id loses what was derived from the old one.
Snapshot with_scan(Snapshot snapshot, const ScanEntry& scan) {
  std::erase_if(snapshot.scans, [&](const ScanEntry& s) { return s.scan_id == scan.scan_id; });
  const auto before = [](const ScanEntry& a, const ScanEntry& b) {
    return std::tie(a.date, a.scan_id) < std::tie(b.date, b.scan_id);
  };
  snapshot.scans.insert(std::upper_bound(snapshot.scans.begin(), snapshot.scans.end(), scan, before), scan);
  return snapshot;
}

Result<AddReport> already_there(const std::filesystem::path& store, const Snapshot& latest,
                                const std::string& scan_id) {
  RAYFIELD_CHECK(sync_directory(store / layout::kSnapshots));
  AddReport report = report_of(*latest.find_scan(scan_id));
  report.already_there = true;
  report.bytes_written = 0;
  return report;
}

}  // namespace

Result<std::optional<AddReport>> find_added_scan(const std::filesystem::path& store, const AddOptions& options) {
  RAYFIELD_ASSIGN(const std::string scan_id, layout::scan_id(options.date, options.name));
  RAYFIELD_ASSIGN(const Snapshot snapshot, latest_snapshot(store));
  const Standing standing = standing_of(snapshot, scan_id, options);
  if (standing == Standing::absent || options.overwrite) return std::nullopt;
  if (standing == Standing::other) return date_taken(store, scan_id);
  RAYFIELD_ASSIGN(AddReport report, already_there(store, snapshot, scan_id));
  return std::optional<AddReport>(std::move(report));
}

// Everything is written and durable before a snapshot names it, so that a crash at any point leaves the store as it
// was. Without working locks another writer may publish the same scan first: then this one's snapshot is not made.
Result<AddReport> add_scan(const OpenStore& open_store, RaySource& rays, const AddOptions& options,
                           Progress& progress) {
  const std::filesystem::path& store = open_store.folder;
  RAYFIELD_ASSIGN(const std::string scan_id, layout::scan_id(options.date, options.name));
  if (options.memory_bytes < PartitionOptions::kLeastMemory)
    return fail(ErrorCode::usage, "cannot add the scan", "memory",
                fmt::format("{} MB are too few", options.memory_bytes >> 20U),
                fmt::format("give at least {} MB", PartitionOptions::kLeastMemory >> 20U));
  RAYFIELD_CHECK(check_attachments(options.attachments));
  RAYFIELD_ASSIGN(const WriterLock lock, WriterLock::take(store));
  RAYFIELD_ASSIGN(const Snapshot before, latest_snapshot(store));
  const Standing standing = standing_of(before, scan_id, options);
  if (standing == Standing::same && !options.overwrite) return already_there(store, before, scan_id);
  if (standing == Standing::other && !options.overwrite) return date_taken(store, scan_id);
  RAYFIELD_CHECK(check_disk(rays, store));

  DurableWriter writer(store);
  SpillFile spill(store / layout::kTemporary);
  const PartitionOptions partition_options{thread_count(options.threads), options.memory_bytes};
  const auto write_file = [&](TileIndex index, std::span<const std::byte> bytes) {
    return writer.write(bytes, layout::rays_directory(scan_id),
                        [&](const std::string& sha256) { return layout::tile_file_name(index, sha256); });
  };
  const auto partitioned = partition(rays, TileGrid(open_store.config), partition_options, spill, write_file, progress);
  if (!partitioned) {
    writer.discard_new_files();
    return tl::make_unexpected(partitioned.error());
  }
  const PartitionResult& result = *partitioned;
  auto attachments = write_attachments(writer, scan_id, options.attachments);
  if (!attachments) {
    writer.discard_new_files();
    return tl::make_unexpected(std::move(attachments).error());
  }
  RAYFIELD_CHECK(writer.sync_directories());

  const ScanEntry scan =
      scan_entry(options, scan_id, result, warnings_of(rays, result.statistics, result.tiles.size(), open_store.config),
                 std::move(*attachments));
  bool lost = false;
  RAYFIELD_ASSIGN(const Snapshot published,
                  publish(store, options.command, [&](const Snapshot& latest) -> Result<std::optional<Snapshot>> {
                    lost = !options.overwrite && latest.find_scan(scan_id) != nullptr;
                    if (lost) return std::nullopt;
                    return with_scan(latest, scan);
                  }));
  if (lost) {
    if (standing_of(published, scan_id, options) == Standing::same) return already_there(store, published, scan_id);
    return date_taken(store, scan_id);
  }
  AddReport report = report_of(scan);
  report.dropped = result.statistics.dropped();
  return report;
}

}  // namespace rayfield::tile
