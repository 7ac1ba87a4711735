#include "cli/products/export_clouds.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "cli/products/export_source.h"
#include "rayfield/density/voxel_cloud.h"
#include "rayfield/formats/point_cloud.h"
#include "rayfield/formats/scale_fit.h"

namespace rayfield::cli {
namespace {

struct CloudFile {
  const char* name;       // of the format
  const char* extension;  // of the file
  formats::PointCloudFormat format;
  double point_bytes;
};
constexpr std::array<CloudFile, 2> kCloudFiles = {{
    {kCloudPly, ".ply", formats::PointCloudFormat::ply, 42},
    {kCloudLas, ".las", formats::PointCloudFormat::las, 40},
}};

density::VoxelCloudOptions cloud_options(const ExportOptions& options, const ExportFolder& folder) {
  return {options.threads, options.memory_bytes, folder.scratch()};
}

// What the estimates of a scan's densities follow from.
void add_scan(const tile::ScanEntry& scan, Source& source) {
  source.add(scan.scan_id).add(scan.date).add(derived_sha256(scan, "estimation", "block"));
  source.add(derived_sha256(scan, "results", "block"));
}

// Of a cloud: the scale is fitted to all scans of the block.
std::string source_of(const tile::Snapshot& snapshot, const tile::ScanEntry& scan, const CloudFile& file,
                      const std::string& crs) {
  Source source(file.name);
  source.add(crs);
  add_scan(scan, source);
  for (const tile::ScanEntry& other : snapshot.scans) add_scan(other, source);
  return source.hex();
}

bool has_results(const tile::ScanEntry& scan) {
  return std::any_of(scan.derived.begin(), scan.derived.end(),
                     [](const tile::DerivedEntry& entry) { return entry.kind == "results"; });
}

// LAS keeps coordinates as whole numbers from here: the south-west corner of the scan's tiles, at height 0.
Eigen::Vector3d offset_of(const tile::Store& store, const tile::ScanEntry& scan) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  for (const tile::TileEntry& entry : scan.tiles)
    low = low.cwiseMin(tile::TileRef{entry.index, store.config().tile_size_m}.corner());
  return {std::floor(low.x()), std::floor(low.y()), 0};
}

// Writes the hits of one scan to all files that are wanted of it, in one pass over its rays.
Result<void> write_clouds(const tile::Store& store, const density::VoxelCloud& cloud, const tile::ScanEntry& scan,
                          std::span<const CloudFile> files, const std::string& stem, const formats::ColorScale& scale,
                          Progress& progress, ExportFolder& folder) {
  const formats::PointCloudOptions write{store.config().crs, scan.date, fmt::format("rayfield {}", kVersion), scale,
                                         offset_of(store, scan)};
  std::vector<formats::PointCloudWriter> writers;
  for (const CloudFile& file : files) {
    RAYFIELD_ASSIGN(formats::PointCloudWriter writer,
                    formats::PointCloudWriter::create(folder.path(stem + file.extension), file.format, write));
    writers.push_back(std::move(writer));
  }
  RAYFIELD_CHECK(cloud.for_hits(progress, [&](const DensityPoints& points) -> Result<void> {
    for (formats::PointCloudWriter& writer : writers) RAYFIELD_CHECK(writer.write(points));
    return {};
  }));
  for (formats::PointCloudWriter& writer : writers) RAYFIELD_CHECK(writer.close());
  return {};
}

}  // namespace

bool wants_clouds(const ExportOptions& options) {
  return std::any_of(kCloudFiles.begin(), kCloudFiles.end(),
                     [&](const CloudFile& file) { return options.formats.count(file.name) > 0; });
}

double cloud_bytes(const tile::ScanEntry& scan, const ExportOptions& options) {
  constexpr double kInRows = 0.6;  // of the hits; the others are ground
  double bytes = 0;
  for (const CloudFile& file : kCloudFiles)
    if (options.formats.count(file.name) > 0) bytes += kInRows * file.point_bytes * static_cast<double>(scan.hit_count);
  return bytes;
}

Result<void> export_clouds(const tile::Store& store, const tile::Snapshot& snapshot, const BlockProducts& block,
                           const ExportOptions& options, Progress& progress, ExportFolder& folder) {
  struct Wanted {
    const tile::ScanEntry* scan;
    std::vector<CloudFile> files;
    std::string stem;
  };
  std::vector<Wanted> wanted;
  for (const ScanResults& results : block.scans) {
    if (results.row_metres.empty()) continue;  // it shows no row
    Wanted cloud{
        snapshot.find_scan(results.scan.scan_id), {}, fmt::format("{}_{}_cloud", block.block, results.scan.scan_id)};
    for (const CloudFile& file : kCloudFiles)
      if (options.formats.count(file.name) > 0 &&
          folder.wants(cloud.stem + file.extension, source_of(snapshot, *cloud.scan, file, block.crs)))
        cloud.files.push_back(file);
    if (!cloud.files.empty()) wanted.push_back(std::move(cloud));
  }
  if (wanted.empty()) return {};
  // The scale needs the densities of all dates; those of the clouds wait in their temporary files.
  formats::ScaleFit fit("voxel_density");
  std::vector<std::optional<density::VoxelCloud>> clouds(wanted.size());
  for (const tile::ScanEntry& scan : snapshot.scans) {
    if (!has_results(scan)) continue;
    RAYFIELD_ASSIGN(density::VoxelCloud cloud,
                    density::VoxelCloud::open(store, scan, cloud_options(options, folder), progress));
    RAYFIELD_CHECK(cloud.for_voxels([&fit](std::span<const float> densities) { fit.add(densities); }));
    fit.end_date();
    const auto of_scan =
        std::find_if(wanted.begin(), wanted.end(), [&scan](const Wanted& w) { return w.scan == &scan; });
    if (of_scan != wanted.end()) clouds[static_cast<std::size_t>(of_scan - wanted.begin())] = std::move(cloud);
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    RAYFIELD_CHECK(write_clouds(store, *clouds[i], *wanted[i].scan, wanted[i].files, wanted[i].stem, fit.scale(),
                                progress, folder));
    clouds[i].reset();
  }
  return {};
}

}  // namespace rayfield::cli
