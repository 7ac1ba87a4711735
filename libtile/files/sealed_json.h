#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "rayfield/core/result.h"

/// JSON documents that name their own SHA-256, so that a flipped bit in them is found like one in any other file:
///
///   {"sha256": "<64 hex digits>",
///   "<what>": <body>}
///
/// The digest is that of the body's bytes as they stand.
namespace rayfield::tile {

std::string seal_json(std::string_view what, const nlohmann::ordered_json& body);
/// Errors: damaged.
Result<nlohmann::ordered_json> unseal_json(std::string_view what, std::string_view text, const std::string& where);
/// Reads and unseals a file. Errors: damaged; what reading gives.
Result<nlohmann::ordered_json> read_sealed_json(std::string_view what, const std::filesystem::path& path);

/// The current time as ISO 8601; SOURCE_DATE_EPOCH (s) in the environment takes its place, for reproducible stores.
std::string now_utc();

}  // namespace rayfield::tile
