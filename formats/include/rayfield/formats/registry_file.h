#pragma once

#include <string>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

/// The rows and posts of a block in a form that read_reference_file() reads back (docs/registry.md): GeoJSON on WGS 84,
/// CSV in the block's CRS, or the GeoPackage of the products without scans, by the path's ending.
/// Errors: usage (unknown ending), resources.
Result<void> write_registry_file(const BlockProducts& block, const std::string& path);

}  // namespace rayfield::formats
