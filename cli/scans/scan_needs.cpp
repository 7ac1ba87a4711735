#include "cli/scans/scan_needs.h"

#include "cli/drives/drive_needs.h"
#include "cli/scans/open_cloud.h"

namespace rayfield::cli {
namespace {

constexpr double kBytesPerRay = 6.3;  // of simulated vineyards (docs/store-format.md), with a trajectory

// What the tiles of the block's scans take for a ray.
double bytes_per_ray(const tile::Snapshot& known) {
  std::uint64_t bytes = 0, rays = 0;
  for (const tile::ScanEntry& scan : known.scans) {
    rays += scan.ray_count;
    for (const tile::TileEntry& tile : scan.tiles) {
      bytes += tile.file.size;
      for (const tile::FileEntry& file : tile.more_files) bytes += file.size;
    }
  }
  return rays > 0 ? static_cast<double>(bytes) / static_cast<double>(rays) : kBytesPerRay;
}

}  // namespace

Result<ScanNeeds> scan_needs(const ScanInputs& inputs, const std::string& crs, const tile::Snapshot& known,
                             std::uint64_t memory_bytes, Progress& progress) {
  ScanNeeds scan;
  Needs registration;
  RAYFIELD_CHECK(check_trajectory_given(inputs));
  RAYFIELD_ASSIGN(const CloudTrajectory trajectory, read_cloud_trajectory(inputs, crs, memory_bytes, progress));
  for (const std::filesystem::path& path : inputs.files) {
    if (is_log(path)) {
      RAYFIELD_CHECK(require_rig(path, inputs));
      RAYFIELD_ASSIGN(const OpenedLog log, open_log(path.string(), inputs.rig_file, crs, progress));
      scan.rays += rays_of(log);
      ++scan.logs;
      registration = registration + registration_needs(log);
      continue;
    }
    RAYFIELD_ASSIGN(const OpenedCloud cloud, open_cloud(path, inputs, crs, trajectory, progress));
    scan.rays += cloud.rays->ray_count().value_or(0);
  }
  // Chunks wait in a temporary file until their tile is complete.
  const auto tiles = static_cast<std::uint64_t>(bytes_per_ray(known) * static_cast<double>(scan.rays));
  scan.needs = registration + Needs{tiles, tiles, memory_bytes};
  return scan;
}

}  // namespace rayfield::cli
