#include "rayfield/density/plan.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "libdensity/leaf/block_seasons.h"
#include "libdensity/learning/block_registry.h"
#include "libdensity/pipeline/processed_scan.h"
#include "libdensity/registry/layout_store.h"

namespace rayfield::density {
namespace {

// Of the first scan of a block: surveys and ground of a tile, counters of voxels for each ray (those of beams that are
// not thin hold more), and all that is made once. Means of simulated blocks; a scan of as many rays in fewer rows takes
// less.
constexpr double kBytesPerTile = 36e3, kBytesPerRay = 0.6, kBytesPerWideRay = 1.2, kBytesPerScan = 0.5e6;

bool all_there(const tile::Store& store, const tile::ScanEntry& scan) {
  return std::all_of(scan.derived.begin(), scan.derived.end(), [&](const tile::DerivedEntry& entry) {
    std::error_code error;
    return std::filesystem::file_size(store.folder() / entry.file.path, error) == entry.file.size && !error;
  });
}

Result<bool> is_needed(const tile::Store& store, const ProcessOptions& options, const tile::ScanEntry& scan,
                       BlockRegistry& registry, const BlockSeasons& seasons) {
  const std::optional<std::string> key = processed_key(options, scan, registry);
  const tile::DerivedEntry* entry = find_processed_entry(scan);
  if (options.redo || !key || entry == nullptr || entry->key != *key || !all_there(store, scan)) return true;
  return seasons.is_outdated(store, scan);
}

std::uint64_t derived_bytes(const tile::ScanEntry& scan) {
  std::uint64_t bytes = 0;
  for (const tile::DerivedEntry& entry : scan.derived) bytes += entry.file.size;
  return bytes;
}

// What processed scans of the block have taken for a unit (a tile, a ray): the largest, since leaves and the wood that
// is subtracted from them double what a bare scan takes. 0 where none was processed.
template <class Units>
double bytes_per_unit(const tile::Snapshot& snapshot, Units&& units_of) {
  double most = 0;
  for (const tile::ScanEntry& scan : snapshot.scans)
    if (find_processed_entry(scan) != nullptr)
      most = std::max(most, static_cast<double>(derived_bytes(scan)) / std::max(1.0, units_of(scan)));
  return most;
}

// A scan that was processed whole takes what it took; another one of the block takes as much for every tile.
std::uint64_t bytes_of_scan(const tile::Snapshot& snapshot, const tile::ScanEntry& scan) {
  if (find_processed_entry(scan) != nullptr) return derived_bytes(scan);
  const auto tiles = [](const tile::ScanEntry& entry) { return static_cast<double>(entry.tiles.size()); };
  if (const double known = bytes_per_unit(snapshot, tiles); known > 0)
    return static_cast<std::uint64_t>(known * tiles(scan));
  const double ray = scan.beam ? kBytesPerWideRay : kBytesPerRay;
  return static_cast<std::uint64_t>(kBytesPerTile * tiles(scan) + ray * static_cast<double>(scan.ray_count) +
                                    kBytesPerScan);
}

constexpr double kRaysPerTile = 110e3;  // of 25 m

}  // namespace

std::uint64_t expected_bytes(const tile::Snapshot& known, std::uint64_t rays) {
  const auto count = static_cast<double>(rays);
  const double of_ray =
      bytes_per_unit(known, [](const tile::ScanEntry& scan) { return static_cast<double>(scan.ray_count); });
  if (of_ray > 0) return static_cast<std::uint64_t>(of_ray * count);
  return static_cast<std::uint64_t>((kBytesPerRay + kBytesPerTile / kRaysPerTile) * count + kBytesPerScan);
}

std::uint64_t ProcessPlan::disk_bytes() const {
  std::uint64_t bytes = 0;
  for (const ScanPlan& scan : scans) bytes += scan.disk_bytes;
  return bytes;
}

Result<ProcessPlan> plan_process(const tile::Store& store, const ProcessOptions& options) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const std::vector<std::string> scan_ids, scans_to_process(store, snapshot, options.dates));
  RAYFIELD_ASSIGN(BlockRegistry registry, BlockRegistry::open(store, snapshot, options));
  RAYFIELD_ASSIGN(const BlockSeasons seasons, BlockSeasons::read(store, snapshot, {}, options.wood.enabled));
  ProcessPlan plan;
  plan.layout_is_new = !registry.known();
  for (const std::string& scan_id : scan_ids) {
    const tile::ScanEntry& scan = *snapshot.find_scan(scan_id);
    RAYFIELD_ASSIGN(const bool needed, is_needed(store, options, scan, registry, seasons));
    plan.scans.push_back({scan_id, needed, needed ? bytes_of_scan(snapshot, scan) : 0});
  }
  return plan;
}

}  // namespace rayfield::density
