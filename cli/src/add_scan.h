#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

/// Adds ray clouds (raycloudtools PLY) to a store as one scan. `options.inputs` is filled here.
/// `allow_truncated`: take what is there of a cloud that was cut short.
Result<tile::AddReport> add_clouds(tile::Store& store, const std::vector<std::filesystem::path>& clouds,
                                   bool allow_truncated, tile::AddOptions options, Progress& progress);

}  // namespace rayfield::cli
