#pragma once

#include <filesystem>
#include <string>

#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::tile {

/// Store::remove(): lock, find the scan, publish a snapshot without it.
Result<RemoveReport> remove_scan(const std::filesystem::path& store, const std::string& scan,
                                 const std::string& command);
/// Store::find_scan_to_remove().
Result<std::string> find_scan_to_remove_in(const std::filesystem::path& store, const std::string& scan);

}  // namespace rayfield::tile
