#pragma once

#include <filesystem>
#include <optional>

#include "libtile/store/open_store.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/add_options.h"

namespace rayfield::tile {

/// Store::add(): lock, partition, make the files durable, publish.
Result<AddReport> add_scan(const OpenStore& open_store, RaySource& rays, const AddOptions& options, Progress& progress);
/// Store::find_added().
Result<std::optional<AddReport>> find_added_scan(const std::filesystem::path& store, const AddOptions& options);

}  // namespace rayfield::tile
