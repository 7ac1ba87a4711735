#pragma once

#include <string>

#include "rayfield/core/result.h"
#include "rayfield/density/registry.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

/// Reads surveyed rows and posts and makes them the block's reference; a dry run says what that would do.
Result<density::ImportReport> take_reference(tile::Store& store, const std::string& file, bool dry_run,
                                             const std::string& command);

}  // namespace rayfield::cli
