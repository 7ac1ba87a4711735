#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

struct SeasonReport {
  std::vector<SeasonValue> values;  ///< as density::season_values() gives them
  std::vector<std::filesystem::path> files;
};

/// All dates of a block: its rows through the season and, into a folder, their curves (CSV, PNG, SVG) and every row's
/// side views of all dates under each other (docs/compare.md). Nothing is written without a folder. Errors: usage (not
/// processed, fewer than two dates), and those of the writers.
Result<SeasonReport> report_season(const tile::Store& store, const std::optional<std::filesystem::path>& folder,
                                   Progress& progress);

}  // namespace rayfield::cli
