#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/core/zone_products.h"
#include "rayfield/density/zones.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

struct RatesRequest {
  std::string file, unit, product;
};

struct ZoneRequest {
  std::string date;                    ///< a scan or its date; empty: the newest
  std::string of = "leaf_area_per_m";  ///< or "plan_density"
  density::ZoneOptions options;
  std::optional<RatesRequest> rates;
  std::set<std::string> profiles;               ///< farm systems for which shapefiles are written
  std::optional<std::filesystem::path> folder;  ///< where products go; nothing is written without
};

struct ZoneReport {
  ZoneMap map;
  std::vector<std::filesystem::path> files;
};

/// Management zones of a block and, with rates, its prescription map (docs/farm-systems.md). Products appear in the
/// folder together. Errors: usage (unknown or ambiguous date, options, rates), bad_input (no values, bad rates), and
/// those of the writers.
Result<ZoneReport> zone_block(const tile::Store& store, const ZoneRequest& request, Progress& progress);

}  // namespace rayfield::cli
