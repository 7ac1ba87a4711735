#pragma once

#include "cli/products/export_block.h"
#include "cli/products/export_folder.h"
#include "rayfield/core/products.h"

namespace rayfield::cli {

/// Names of the formats of point clouds.
inline constexpr const char* kCloudPly = "ply";
inline constexpr const char* kCloudLas = "las";

/// Whether an export has point clouds.
bool wants_clouds(const ExportOptions& options);

/// The hits of the scans coloured by the density of their voxels, on one scale for all dates of the block
/// (docs/products.md, "Point cloud"). Errors: as density::VoxelCloud.
Result<void> export_clouds(const tile::Store& store, const tile::Snapshot& snapshot, const BlockProducts& block,
                           const ExportOptions& options, Progress& progress, ExportFolder& folder);

/// Bytes of a scan's clouds, from its hits.
double cloud_bytes(const tile::ScanEntry& scan, const ExportOptions& options);

}  // namespace rayfield::cli
