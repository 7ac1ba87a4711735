#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "rayfield/tile/snapshot.h"

namespace rayfield::cli {

/// How a scan lies on its block, in one line and as JSON (docs/commands.md).
std::string alignment_text(const tile::ScanAlignment& alignment);
nlohmann::ordered_json alignment_json(const tile::ScanAlignment& alignment);

}  // namespace rayfield::cli
