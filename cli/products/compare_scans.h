#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"
#include "rayfield/density/comparison.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

struct ComparisonRequest {
  std::string a, b;  ///< scan ids, or dates with one scan
  density::ComparisonOptions options;
  std::optional<std::filesystem::path> folder;  ///< where products go; nothing is written without
};

struct ComparisonReport {
  DateComparison comparison;
  std::vector<std::filesystem::path> files;
};

/// Two dates of a block: their comparison and, into a folder, scatter chart (PNG, SVG), change maps (GeoTIFF, PNG), the
/// layer `panel_change` and its CSV (docs/compare.md). Errors: usage (unknown or ambiguous date, the same scan twice,
/// not processed), bad_input (no panel was seen on both), and those of the writers.
Result<ComparisonReport> compare_scans(const tile::Store& store, const ComparisonRequest& request, Progress& progress);

}  // namespace rayfield::cli
