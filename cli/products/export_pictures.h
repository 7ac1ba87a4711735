#pragma once

#include <string>

#include "cli/products/block_scales.h"
#include "cli/products/export_block.h"
#include "cli/products/export_folder.h"
#include "rayfield/core/products.h"

namespace rayfield::cli {

/// What the pictures of a block's scans are drawn from.
struct PictureExport {
  const tile::Store& store;
  const tile::Snapshot& snapshot;
  const BlockProducts& block;
  const BlockScales& scales;
  const ExportOptions& options;
  std::string layout;     ///< digest of the rows' layout
  std::string reference;  ///< "GDA2020 / MGA zone 54 (EPSG:7854)"
};

/// Whether an export has pictures.
bool wants_pictures(const ExportOptions& options);

/// How people call the CRS of a block, with its code.
std::string reference_name(const std::string& crs);

/// The density map of one scan, its side views and its end-on sections, as PNG and as SVG where they are wanted.
Result<void> export_pictures(const PictureExport& pictures, const ScanResults& results, ExportFolder& folder);

}  // namespace rayfield::cli
