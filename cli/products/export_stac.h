#pragma once

#include <string>

#include "cli/products/export_folder.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

/// Writes a STAC Item for every scan of `block`, and the Collection. Scans of the snapshot that are not exported, but
/// whose Items lie in the folder from before, stay in the Collection. `source`: what the whole export is made of.
/// Errors: those of write_stac_item(), damaged.
Result<void> export_stac(const tile::Store& store, const tile::Snapshot& snapshot, const BlockProducts& block,
                         const std::string& source, ExportFolder& folder);

}  // namespace rayfield::cli
