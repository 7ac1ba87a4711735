#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "rayfield/core/result.h"
#include "rayfield/tile/snapshot.h"
#include "rayfield/tile/store_config.h"

/// Snapshots and the store's own description as JSON (docs/store-format.md). Key order is fixed.
namespace rayfield::tile {

nlohmann::ordered_json to_json(const Snapshot& snapshot);
/// Errors: damaged (missing keys, wrong types, paths that lead out of the store), bad_input (newer format).
Result<Snapshot> snapshot_from_json(const nlohmann::ordered_json& json, const std::string& where);

/// The alignment in alignment.json, which is kept with a scan; nothing if it is not such a file.
std::optional<ScanAlignment> alignment_from_file(const std::string& text);

nlohmann::ordered_json to_json(const StoreConfig& config);
Result<StoreConfig> config_from_json(const nlohmann::ordered_json& json, const std::string& where);

}  // namespace rayfield::tile
