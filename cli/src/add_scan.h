#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

/// Adds ray clouds (raycloudtools PLY) to a store as one scan. `options.inputs` is filled here.
Result<tile::AddReport> add_clouds(tile::Store& store, const std::vector<std::filesystem::path>& clouds,
                                   tile::AddOptions options, Progress& progress);

}  // namespace rayfield::cli
