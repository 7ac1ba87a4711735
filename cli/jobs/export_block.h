#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

/// What `rayfield export` writes.
struct ExportOptions {
  std::set<std::string> formats = {"geotiff", "gpkg", "png"};
  std::vector<std::string> dates;  ///< scan ids or dates; empty = all
};

/// Writes the products of a block into a folder and returns the paths written, in a fixed order.
Result<std::vector<std::filesystem::path>> export_block(const tile::Store& store, const std::filesystem::path& folder,
                                                        const ExportOptions& options, Progress& progress);

}  // namespace rayfield::cli
