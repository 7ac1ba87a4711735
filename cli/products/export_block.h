#pragma once
/// products: maps, comparisons and reports of a block, from its store into a folder.
#include <cstdint>
#include <filesystem>
#include <optional>
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
  std::set<std::string> profiles;                       ///< farm systems for which shapefiles are written
  std::vector<std::string> dates;                       ///< scan ids or dates; empty = all
  std::optional<std::uint64_t> snapshot;                ///< number; the newest if absent
  bool keep_unchanged = false;                          ///< leave products in the folder that would be made of the same
  bool overwrite = false;                               ///< replace a GeoPackage even if something is lost with it
  int threads = 0;                                      ///< for point clouds, 0 = all processors
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< bound on what point clouds have resident
};

/// What was exported.
struct ExportReport {
  std::uint64_t snapshot = 0;                   ///< that all of it is of
  std::vector<std::filesystem::path> products;  ///< in a fixed order
  std::size_t written = 0;                      ///< of the products; the others were kept
};

/// Writes the products of a block into a folder, in which they appear together. All are of one snapshot, whatever other
/// writers do meanwhile. Errors: usage where a GeoPackage would be replaced by one with less in it.
Result<ExportReport> export_block(const tile::Store& store, const std::filesystem::path& folder,
                                  const ExportOptions& options, Progress& progress);

}  // namespace rayfield::cli
